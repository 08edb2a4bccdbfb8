#include "tiles/tile_cells.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "spatial/facet_tree.h"
#include "tests/delaunay/random_complex.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"
#include "tests/tiles/scene_plans.h"
#include "tiles/ray_mask.h"
#include "tiles/tile_cut.h"

namespace colmap_ext::tile_cells_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

// In a flat box.
std::vector<Vector3f> FlatPoints(size_t count, Random* random) {
  std::vector<Vector3f> points;
  for (size_t i = 0; i < count; ++i) {
    const float z = random->Between(0, 1);
    const float y = random->Between(0, 10);
    points.emplace_back(random->Between(0, 10), y, z);
  }
  return points;
}

TEST(SplitTree, PartsAreOfAboutEqualWeightAndHoldAllPlaces) {
  Random random(1);
  const std::vector<Vector3f> points = RandomPoints(20000, 100000, &random);
  std::vector<float> weights;
  for (const Vector3f& point : points) {
    weights.push_back(point.x() > 0 ? 3 : 1);
  }
  for (const size_t num_parts : {1, 2, 3, 7, 16}) {
    const SplitTree tree(points, weights, num_parts);
    std::vector<double> sums(num_parts, 0);
    double total = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      ASSERT_LT(tree.PartOf(points[i]), num_parts);
      sums[tree.PartOf(points[i])] += weights[i];
      total += weights[i];
    }
    const double mean = total / static_cast<double>(num_parts);
    EXPECT_GT(std::ranges::min(sums), 0.98 * mean);
    EXPECT_LT(std::ranges::max(sums), 1.02 * mean);
    EXPECT_LT(tree.PartOf({1e9f, -1e9f, 0}), num_parts);  // far from all points
  }
}

TEST(TileCells, AreThePartsOfTheTree) {
  Random random(1);
  const auto points = FlatPoints(2000, &random);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 13);
  const TileCells cells = tree.Cells();
  ASSERT_EQ(cells.size(), 13);
  for (const Vector3f& point : points) {
    EXPECT_EQ(CellOf(cells, point), tree.PartOf(point));
    EXPECT_EQ(CellOf(cells, 100 * point), tree.PartOf(100 * point));
  }
}

// Small facets all over the plane.
TriangleMesh MakeFacets(const std::vector<Vector3f>& points) {
  return MakeTriangles(points.size(), [&](uint32_t i, int k) -> Vector3f {
    return points[i] + Vector3f(k == 1 ? 0.1F : 0, k == 2 ? 0.1F : 0, 0);
  });
}

TEST(ColorTiles, KeepsTilesOfOneColorApart) {
  Random random(2);
  const auto points = FlatPoints(5000, &random);
  const TriangleMesh mesh = MakeFacets(points);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 16);
  const TileCells cells = tree.Cells();
  const std::vector<uint32_t> colors =
      ColorTiles(cells, std::vector<float>(16, 0.2F), mesh);
  EXPECT_LE(*std::ranges::max_element(colors), 5);
  for (const Facet& facet : mesh.facets) {
    std::vector<uint32_t> met;
    for (uint32_t tile = 0; tile < 16; ++tile) {
      if (GrowBox(cells[tile], 0.2F).intersects(BoxOf(mesh, facet))) {
        met.push_back(colors[tile]);
      }
    }
    std::ranges::sort(met);
    EXPECT_EQ(std::ranges::adjacent_find(met), met.end());
  }
}

TEST(MayHide, IsTrueOfWhatLiesBetween) {
  Random random(3);
  const auto corner = [&random](double size) -> Vector3f {
    return RandomVector(&random, size).cast<float>();
  };
  size_t num_hiding = 0;
  for (int i = 0; i < 2000; ++i) {
    Eigen::AlignedBox3f seen(corner(1));
    seen.extend(corner(1));
    Eigen::AlignedBox3f box(corner(2));
    box.extend(Vector3f(box.min() + corner(1)));
    const Vector3f center = corner(8);
    const bool may_hide = MayHide(box, center, seen);
    num_hiding += may_hide ? 1 : 0;
    // Points of the hull within the box.
    for (int k = 0; k < 50; ++k) {
      const Vector3f target = seen.sample();
      const Vector3f point = center + random.Between(0, 1) * (target - center);
      EXPECT_TRUE(may_hide || !box.contains(point));
    }
  }
  EXPECT_GT(num_hiding, 50);
  EXPECT_LT(num_hiding, 1000);
}

// Compares a tile's graph and labels with those of all vertices.
class TileAndWhole {
 public:
  TileAndWhole(const SeenScene& scene, const MemoryPlan& plan)
      : scene_(scene),
        plan_(plan),
        whole_(scene, plan),
        cells_(whole_.CellsByKey()) {}

  void Compare(uint32_t tile) {
    const TileCut cut = CutTile(plan_, tile, scene_.centers, scene_.options);
    EXPECT_EQ(cut.rays.num_lost_rays, 0u);
    for (uint32_t i = 0; i < cut.tile.tetrahedra.cells.size(); ++i) {
      if (cut.places[i] == CellPlace::kBeyond) {
        EXPECT_EQ(cut.labels.known[i], kNotKnown);
        continue;
      }
      ++num_star_;
      const auto found = cells_.find(Sorted(cut.tile.CornersOf(i)));
      ASSERT_NE(found, cells_.end());
      CompareCell(cut, i, found->second);
      if (cut.labels.known[i] != kNotKnown) {
        ++num_known_;
        EXPECT_EQ(cut.labels.known[i], whole_.labels[found->second]);
      }
    }
  }

  double KnownShare() const {
    return static_cast<double>(num_known_) / static_cast<double>(num_star_);
  }

 private:
  void CompareCell(const TileCut& cut, uint32_t cell, uint32_t whole_cell) {
    const NodeCapacities& whole_node = whole_.graph[whole_cell];
    EXPECT_EQ(cut.graph[cell].source, whole_node.source);
    EXPECT_EQ(cut.graph[cell].sink, whole_node.sink);
    const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
    const CellKey corners = cut.tile.CornersOf(cell);
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t place = whole_.tetrahedra.IndexOf(whole_cell, corners[k]);
      EXPECT_EQ(cut.graph[cell].arcs[k], whole_node.arcs[place]);
      const uint32_t other = tetrahedra.cells[cell].neighbors[k];
      const uint32_t whole_other =
          whole_.tetrahedra.cells[whole_cell].neighbors[place];
      EXPECT_EQ(cut.graph[other].arcs[tetrahedra.FacetTo(other, cell)],
                whole_.graph[whole_other]
                    .arcs[whole_.tetrahedra.FacetTo(whole_other, whole_cell)]);
    }
  }

  const SeenScene& scene_;
  const MemoryPlan& plan_;
  WholeCut whole_;
  std::map<CellKey, uint32_t> cells_;
  size_t num_star_ = 0;
  size_t num_known_ = 0;
};

void ExpectSameCut(const SeenScene& scene, size_t num_tiles,
                   double min_known_share) {
  const MemoryPlan plan = PlanOf(scene, num_tiles);
  TileAndWhole both(scene, plan);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    both.Compare(tile);
  }
  EXPECT_GE(both.KnownShare(), min_known_share);
}

// On a sphere, on the ground, and where rays end in the air. One tile knows
// all.
TEST(CutTile, VotesAndLabelsAreThoseOfAllPoints) {
  ExpectSameCut(SphereScene(5000, 1), 3, 0.3);
  ExpectSameCut(GroundScene(10000, 2), 4, 0.4);
  ExpectSameCut(GroundSceneWithEnds(6000, 4), 4, 0.3);
  ExpectSameCut(SphereScene(2000, 3), 1, 1);
}

// Rays through vertices, along edges and within facets of the tiles'
// tetrahedra, from vertices of others that lie on such facets, and to cameras
// that do. In units whose multiples are rounded cells are nearly flat.
TEST(CutTile, VotesAreThoseOfAllPointsOfALattice) {
  ExpectSameCut(LatticeScene(1, 1 / 150.0f), 4, -1);
  ExpectSameCut(BoxScene(), 3, -1);
  // The hull of what a tile has need not hold the middle of all points.
  for (const uint64_t seed : {1, 2}) {
    ExpectSameCut(ClustersScene(seed), 3, -1);
  }
}

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
  for (const Vector3f& point : all.points) {
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

std::vector<Vector3f> OnSphere(uint64_t seed) {
  Random random(seed);
  std::vector<Vector3f> points(8000);
  for (Vector3f& point : points) {
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
  // A tile and all that is around it in a plane.
  std::vector<Vector3f> points;
  for (int i = 0; i < 4000; ++i) {
    points.push_back(RandomPoint(&random).cwiseProduct(Vector3f(1, 1, 0)));
  }
  for (int i = 0; i < 20; ++i) {
    points.push_back(RandomPoint(&random) + Vector3f(50, 0, 0));
  }
  ExpectStarsOfAll(PlanOf(points, 4));
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

}  // namespace colmap_ext::tile_cells_test
