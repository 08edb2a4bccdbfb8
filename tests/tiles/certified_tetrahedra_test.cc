#include "tiles/certified_tetrahedra.h"

#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/delaunay/random_complex.h"
#include "tests/tiles/memory_plan.h"

namespace colmap_ext {
namespace certified_tetrahedra_test {

using Corners = std::array<uint32_t, 4>;

// The cells at some vertices and those beside them, each by its sorted corners.
std::set<Corners> StarCells(const Tetrahedralization& tetrahedra,
                            const std::vector<uint32_t>& ids, uint32_t begin,
                            uint32_t end) {
  const auto corners_of = [&](uint32_t cell) {
    Corners corners = tetrahedra.cells[cell].vertices;
    for (uint32_t& corner : corners) {
      corner = corner == kInfiniteVertex ? corner : ids[corner];
    }
    std::ranges::sort(corners);
    return corners;
  };
  std::set<Corners> cells;
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    const Corners corners = corners_of(cell);
    if (std::ranges::any_of(
            corners, [&](uint32_t id) { return id >= begin && id < end; })) {
      cells.insert(corners);
      for (const uint32_t neighbor : tetrahedra.cells[cell].neighbors) {
        cells.insert(corners_of(neighbor));
      }
    }
  }
  return cells;
}

// By the plan's numbers.
std::vector<uint32_t> IdsOf(const MemoryPlan& plan,
                            const Tetrahedralization& tetrahedra) {
  std::vector<uint32_t> ids;
  for (const Eigen::Vector3f& point : tetrahedra.points) {
    ids.push_back(static_cast<uint32_t>(
        std::ranges::find(plan.positions(), point) - plan.positions().begin()));
  }
  return ids;
}

void ExpectStarsOfAll(const MemoryPlan& plan) {
  const Tetrahedralization all = DelaunayOf(plan.positions());
  const std::vector<uint32_t> ids = IdsOf(plan, all);
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    const TileTetrahedra part = CertifyTile(plan, tile);
    EXPECT_EQ(DefectOf(part.tetrahedra, false), "");
    const uint32_t begin = plan.Blocks().FirstVertex(tile);
    const uint32_t end = plan.Blocks().FirstVertex(tile + 1);
    EXPECT_EQ(part.num_own, end - begin);
    EXPECT_TRUE(StarCells(part.tetrahedra, part.ids, begin, end) ==
                StarCells(all, ids, begin, end));
  }
}

std::vector<Eigen::Vector3f> OnSphere(size_t num_points, Random* random) {
  std::vector<Eigen::Vector3f> points;
  while (points.size() < num_points) {
    const Eigen::Vector3d p(2 * random->Unit() - 1, 2 * random->Unit() - 1,
                            2 * random->Unit() - 1);
    if (p.norm() < 1 && p.norm() > 0.1) {
      points.push_back(p.normalized().cast<float>());
    }
  }
  return points;
}

TEST(CertifyTile, StarsAreThoseOfAllPoints) {
  Random random(1);
  for (const size_t num_tiles : {1, 2, 5}) {
    ExpectStarsOfAll(PlanOf(RandomPoints(4000, 10000, &random), num_tiles));
  }
}

// Every cell within spans from one side to the other.
TEST(CertifyTile, StarsOnASphere) {
  Random random(2);
  ExpectStarsOfAll(PlanOf(OnSphere(8000, &random), 4));
}

TEST(CertifyTile, StarsOfDifficultPoints) {
  for (const NamedPoints& named : DifficultPoints()) {
    SCOPED_TRACE(named.name);
    for (const size_t num_tiles : {2, 3}) {
      if (named.points.size() >= 4 * num_tiles) {
        ExpectStarsOfAll(PlanOf(named.points, num_tiles));
      }
    }
  }
}

// A tile and all that is around it in a plane.
TEST(CertifyTile, StarsOfAPlane) {
  Random random(4);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i) {
    points.emplace_back(static_cast<float>(random.Unit()),
                        static_cast<float>(random.Unit()), 0.0f);
  }
  for (int i = 0; i < 20; ++i) {
    points.emplace_back(static_cast<float>(50 + random.Unit()),
                        static_cast<float>(random.Unit()),
                        static_cast<float>(random.Unit()));
  }
  ExpectStarsOfAll(PlanOf(points, 4));
}

TEST(CertifyTile, DoesNotDependOnThreads) {
  Random random(3);
  const MemoryPlan plan = PlanOf(OnSphere(8000, &random), 3);
  const TileTetrahedra many = CertifyTile(plan, 1);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);
  const TileTetrahedra alone = CertifyTile(plan, 1);
  EXPECT_EQ(many.ids, alone.ids);
  ASSERT_EQ(many.tetrahedra.cells.size(), alone.tetrahedra.cells.size());
  for (size_t i = 0; i < many.tetrahedra.cells.size(); ++i) {
    EXPECT_EQ(many.tetrahedra.cells[i].vertices,
              alone.tetrahedra.cells[i].vertices);
  }
}

}  // namespace certified_tetrahedra_test
}  // namespace colmap_ext
