#include "tiles/tile_cut.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"
#include "tests/random_vectors.h"
#include "tests/threads.h"
#include "tests/tiles/memory_plan.h"
#include "tiles/ray_mask.h"

namespace colmap_ext::certified_tetrahedra_test {

using Eigen::Vector3d;

// The cells at some vertices and those beside them, each by its sorted corners.
std::set<CellKey> StarCells(const Tetrahedralization& tetrahedra,
                            const std::vector<uint32_t>& ids, uint32_t begin,
                            uint32_t end) {
  const auto corners_of = [&](uint32_t cell) {
    return Sorted(IdsOf(tetrahedra.cells[cell].vertices, ids));
  };
  std::set<CellKey> cells;
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    const CellKey corners = corners_of(cell);
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

void ExpectStarsOfAll(const MemoryPlan& plan) {
  const Tetrahedralization all = DelaunayOf(plan.positions());
  std::vector<uint32_t> ids;  // the plan's
  for (const Eigen::Vector3f& point : all.points) {
    ids.push_back(static_cast<uint32_t>(
        std::ranges::find(plan.positions(), point) - plan.positions().begin()));
  }
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

std::vector<Eigen::Vector3f> OnSphere(uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3f> points(8000);
  for (Eigen::Vector3f& point : points) {
    point = RandomNormal(&random).cast<float>();
  }
  return points;
}

TEST(CertifyTile, StarsAreThoseOfAllPoints) {
  Random random(1);
  for (const size_t num_tiles : {1, 2, 5}) {
    ExpectStarsOfAll(PlanOf(RandomPoints(4000, 10000, &random), num_tiles));
  }
  // Every cell within spans from one side to the other.
  ExpectStarsOfAll(PlanOf(OnSphere(2), 4));
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
  const MemoryPlan plan = PlanOf(OnSphere(3), 3);
  ExpectSameForAnyThreads([&] {
    TileTetrahedra tile = CertifyTile(plan, 1);
    return std::pair(std::move(tile.ids), std::move(tile.tetrahedra));
  });
}

// In a cube.
Vector3d Anywhere(double from, double to, Random* random) {
  return RandomVector(random, (to - from) / 2).array() + (from + to) / 2;
}

// Of a tetrahedron or a triangle.
Vector3d Within(const std::vector<Vector3d>& corners, Random* random) {
  Vector3d sum = Vector3d::Zero();
  double total = 0;
  for (const Vector3d& corner : corners) {
    const double weight = random->Unit() + 1e-9;
    sum += weight * corner;
    total += weight;
  }
  return sum / total;
}

TEST(RayMask, LeavesOutNoRayThroughWhatIsMarked) {
  Random random(1);
  const Eigen::AlignedBox3d bounds(Vector3d(0, 0, 0), Vector3d(10, 10, 1));
  for (int i = 0; i < 200; ++i) {
    RayMask mask(bounds);
    std::vector<Vector3d> corners;
    const int num_corners = 3 + static_cast<int>(random.Below(2));
    for (int k = 0; k < num_corners; ++k) {
      corners.push_back(Anywhere(0, 1, &random).cwiseProduct(bounds.max()));
    }
    mask.Mark(corners);
    mask.Finish();
    for (int k = 0; k < 50; ++k) {
      const Vector3d from = Anywhere(-5, 15, &random);
      const Vector3d through = Within(corners, &random);
      const Vector3d to = through + random.Unit() * (through - from);
      const Vector3d direction = (to - from).normalized();
      EXPECT_TRUE(mask.MayPass(from, direction, (to - from).norm()));
      EXPECT_TRUE(mask.MayPass(to, -direction,
                               std::numeric_limits<double>::infinity()));
      EXPECT_TRUE(mask.MayTouch(Eigen::AlignedBox3d(through).extend(from)));
    }
  }
}

TEST(RayMask, LeavesOutMostRaysElsewhere) {
  Random random(2);
  RayMask mask({Vector3d(0, 0, 0), Vector3d(10, 10, 10)});
  const std::vector<Vector3d> corners = {
      {1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
  mask.Mark(corners);
  mask.Finish();
  EXPECT_FALSE(mask.MayTouch({Vector3d(5, 5, 5), Vector3d(9, 9, 9)}));
  size_t num_crossing = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d from = Anywhere(0, 10, &random);
    const Vector3d way = Anywhere(0, 10, &random) - from;
    num_crossing += mask.MayPass(from, way.normalized(), way.norm());
  }
  EXPECT_LT(num_crossing, 100u);
}

}  // namespace colmap_ext::certified_tetrahedra_test
