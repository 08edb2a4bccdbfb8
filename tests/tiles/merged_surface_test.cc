#include "tiles/merged_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "delaunay/cell_graph.h"
#include "mesh/manifold_repair.h"
#include "mesh/topology.h"
#include "meshing/singular_vertices.h"
#include "tests/tiles/merged_plan.h"

namespace colmap_ext {
namespace merged_surface_test {

// A facet by its corners' positions, turned so that the lowest comes first.
using Corner = std::array<float, 3>;
using Triangle = std::array<Corner, 3>;

std::multiset<Triangle> TrianglesOf(const TriangleMesh& mesh) {
  std::multiset<Triangle> triangles;
  for (const Facet& facet : mesh.facets) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.vertices[facet[k]];
      triangle[k] = {p.x(), p.y(), p.z()};
    }
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
    triangles.insert(triangle);
  }
  return triangles;
}

// The surface of all vertices on one machine.
TriangleMesh SurfaceOfWhole(const SeenScene& scene, const MemoryPlan& plan,
                            bool is_fixed) {
  WholeCut whole = CutWhole(scene, plan);
  if (is_fixed) {
    FixSingularVertices(FixingRule::kEnergy, &whole.tetrahedra, &whole.graph,
                        &whole.labels);
  }
  const ExtractedSurface extracted =
      ExtractSurface(whole.tetrahedra, whole.labels);
  return SplitFans(extracted.mesh, extracted.partners).mesh;
}

TriangleMesh SurfaceOfPlan(const MergedPlan& merged) {
  const ExtractedSurface extracted =
      MergeSurface(merged.plan, merged.Labeled(), merged.changes.centroids())
          .extracted;
  return SplitFans(extracted.mesh, extracted.partners).mesh;
}

void ExpectSameSurface(const SeenScene& scene, size_t num_tiles,
                       bool is_fixed) {
  SCOPED_TRACE(num_tiles);
  const MergedPlan plan(
      scene, num_tiles,
      is_fixed ? std::optional(FixingRule::kEnergy) : std::nullopt);
  EXPECT_EQ(plan.num_contradictions, 0u);
  const TriangleMesh merged = SurfaceOfPlan(plan);
  const TriangleMesh whole = SurfaceOfWhole(scene, plan.plan, is_fixed);
  EXPECT_TRUE(Analyze(merged).IsManifold()) << Analyze(merged).Defects();
  EXPECT_GT(merged.facets.size(), 100u);
  EXPECT_EQ(merged.vertices.size(), whole.vertices.size());
  const auto a = TrianglesOf(merged);
  const auto b = TrianglesOf(whole);
  std::vector<Triangle> only_a;
  std::vector<Triangle> only_b;
  std::ranges::set_difference(a, b, std::back_inserter(only_a));
  std::ranges::set_difference(b, a, std::back_inserter(only_b));
  EXPECT_EQ(only_a.size(), 0u);
  EXPECT_EQ(only_b.size(), 0u);
}

size_t NumSingular(const SeenScene& scene) {
  const WholeCut whole =
      CutWhole(scene, PlanOf(scene.points, 1, scene.observations));
  return SingularVertices(whole.tetrahedra, whole.labels).size();
}

TEST(MergeSurface, IsThatOfOneMachine) {
  for (const size_t num_tiles : {1, 2, 4, 8}) {
    ExpectSameSurface(SphereScene(3000, 4), num_tiles, false);
    ExpectSameSurface(GroundScene(4000, 5), num_tiles, false);
  }
}

TEST(MergeSurface, IsThatOfOneMachineWithSingularVerticesFixed) {
  for (const uint64_t seed : {6, 7, 8}) {
    SeenScene scene = SphereScene(3000, seed, 0.1);
    scene.options.quality_regularization = 0.05;
    EXPECT_GT(NumSingular(scene), 100u);
    for (const size_t num_tiles : {1, 3, 6}) {
      ExpectSameSurface(scene, num_tiles, true);
    }
  }
}

TEST(MergeSurface, IsThatOfOneMachineOnALattice) {
  ExpectSameSurface(LatticeScene(1), 8, true);
  ExpectSameSurface(BoxScene(1 / 150.0f), 2, false);
}

// As users merge.
TEST(MergeSurface, IsManifoldOnALattice) {
  for (SeenScene scene : {LatticeScene(2, 1 / 400.0f), BoxScene()}) {
    scene.options.seam_rings = 4;
    const TriangleMesh mesh =
        SurfaceOfPlan(MergedPlan(scene, 4, FixingRule::kEnergy));
    EXPECT_TRUE(Analyze(mesh).IsManifold()) << Analyze(mesh).Defects();
    EXPECT_GT(mesh.facets.size(), 500u);
  }
}

// Vertices of a plan and centroids at which the surface is more than one fan.
std::set<uint32_t> SingularOf(const MergedPlan& merged) {
  std::set<uint32_t> singular;
  for (uint32_t tile = 0; tile < merged.plan.Blocks().NumTiles(); ++tile) {
    const TilePart part = merged.Labeled().Read(tile);
    for (const uint32_t vertex :
         SingularVertices(part.tile.tetrahedra, part.labels)) {
      const uint32_t id = part.tile.ids[vertex];
      if (merged.changes.TileOf(id) == tile) {
        singular.insert(id);
      }
    }
  }
  return singular;
}

// Noise that leaves many singular vertices.
SeenScene NoisyScene(uint64_t seed) {
  SeenScene scene = SphereScene(3000, seed, 0.1);
  scene.options.quality_regularization = 0.05;
  scene.options.seam_rings = 4;
  return scene;
}

TEST(FixPlan, FixesTileByTileNearlyAllAndCountsTheOthers) {
  for (const FixingRule rule : {FixingRule::kEnergy, FixingRule::kPaper}) {
    size_t num_raw = 0;
    size_t num_split = 0;
    size_t num_left = 0;
    for (const uint64_t seed : {6, 7, 8}) {
      const MergedPlan merged(NoisyScene(seed), 6, rule);
      const TriangleMesh mesh = SurfaceOfPlan(merged);
      EXPECT_TRUE(Analyze(mesh).IsManifold()) << Analyze(mesh).Defects();
      EXPECT_EQ(merged.report.num_singular_fixed, SingularOf(merged).size());
      num_raw += merged.report.num_singular_raw;
      num_split += merged.report.num_split_cells;
      num_left += merged.report.num_singular_fixed;
      EXPECT_EQ(merged.report.num_split_cells,
                merged.changes.centroids().size());
    }
    EXPECT_GT(num_raw, 300u);
    EXPECT_GT(num_split, 0u);
    EXPECT_LT(num_left, num_raw / 3);
  }
}

TEST(FixPlan, LeavesNoMoreThanOneMachine) {
  size_t num_left_here = 0;
  size_t num_left_there = 0;
  for (const uint64_t seed : {6, 7, 8}) {
    SeenScene scene = NoisyScene(seed);
    num_left_here +=
        MergedPlan(scene, 6, FixingRule::kEnergy).report.num_singular_fixed;
    scene.options.seam_rings = kAllAtOnce;
    num_left_there +=
        MergedPlan(scene, 6, FixingRule::kEnergy).report.num_singular_fixed;
  }
  EXPECT_LE(num_left_here, num_left_there + num_left_there / 4);
}

// Each facet of a tile's own and each of the neighbors' at it, from both tiles.
TEST(SurfaceOf, TilesAgreeOnWhatFixingHasChanged) {
  const MergedPlan merged(NoisyScene(6), 6, FixingRule::kEnergy);
  std::multiset<Facet> facets;
  for (uint32_t tile = 0; tile < 6; ++tile) {
    const TileSurface surface = SurfaceOf(merged.Labeled(), tile);
    for (const Facet& facet : surface.facets) {
      facets.insert(Sorted(facet));
    }
  }
  for (const Facet& facet : facets) {
    EXPECT_EQ(facets.count(facet), 1u);
  }
}

// What the cut of a merged plan costs over that of one machine, as a share.
double ExtraEnergy(const SeenScene& scene, size_t num_tiles) {
  const MergedPlan merged(scene, num_tiles);
  const WholeCut whole = CutWhole(scene, merged.plan);
  const std::map<CellKey, uint32_t> cells = CellsByKey(whole);
  std::vector<uint8_t> labels(whole.labels.size(), kNotKnown);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    const TilePart part = merged.Labeled().Read(tile);
    for (uint32_t cell = 0; cell < part.labels.size(); ++cell) {
      if (part.tile.IsStarCell(cell)) {
        uint8_t& label = labels[cells.at(
            KeyOf(part.tile.tetrahedra.cells[cell], part.tile.ids))];
        EXPECT_TRUE(label == kNotKnown || label == part.labels[cell]);
        label = part.labels[cell];
      }
    }
  }
  EXPECT_EQ(std::ranges::count(labels, kNotKnown), 0);
  const NeighborView neighbors = NeighborsOf(whole.tetrahedra);
  const auto least =
      static_cast<double>(CutValue(neighbors, whole.graph, whole.labels));
  return static_cast<double>(CutValue(neighbors, whole.graph, labels)) / least -
         1;
}

TEST(CutSeams, NarrowBandsCostNextToNothing) {
  SeenScene scene = GroundScene(10000, 11);
  scene.options.seam_rings = 4;
  const double extra = ExtraEnergy(scene, 4);
  EXPECT_GE(extra, 0);
  EXPECT_LT(extra, 1e-3);
  scene.options.seam_rings = kAllAtOnce;
  EXPECT_EQ(ExtraEnergy(scene, 4), 0);
}

// Tiles that guess wrong, and windows that see no more than their tile and a
// few rings.
TEST(CutSeams, MakesGoodForBadGuesses) {
  SeenScene scene = GroundScene(10000, 11);
  scene.options.seam_rings = 4;
  const MemoryPlan plan = PlanOf(scene.points, 4, scene.observations);
  MemoryParts parts(scene, plan);
  SeamLabels told(plan.Blocks(), parts);
  CutSeams(scene.options.seam_rings, &told);
  for (uint32_t tile = 0; tile < 4; ++tile) {
    TileSeam seam = parts.ReadSeam(tile);
    for (UnknownCell& cell : seam.unknown) {
      cell.guess = kFreeSpace;
    }
    parts.SetSeam(tile, seam);
  }
  SeamLabels guessed(plan.Blocks(), parts);
  CutSeams(scene.options.seam_rings, &guessed);
  size_t num_cells = 0;
  size_t num_other = 0;
  for (uint32_t tile = 0; tile < 4; ++tile) {
    for (const UnknownCell& cell : parts.ReadSeam(tile).unknown) {
      ++num_cells;
      num_other += told.At(cell.key) != guessed.At(cell.key);
    }
  }
  EXPECT_GT(num_cells, 1000u);
  EXPECT_LT(num_other, num_cells / 100);
}

TEST(CutSeams, CountsWhatTilesTellDifferently) {
  const SeenScene scene = SphereScene(2000, 10);
  const MemoryPlan plan = PlanOf(scene.points, 3, scene.observations);
  SeenScene other = scene;
  other.options.rays.distance_sigma = 0.1;
  MemoryParts parts(scene, plan);
  for (const int seam_rings : {4, kAllAtOnce}) {
    SeamLabels labels(plan.Blocks(), parts);
    EXPECT_EQ(CutSeams(seam_rings, &labels), 0u);
  }
  parts.SetSeam(1, MemoryParts(other, plan).ReadSeam(1));
  for (const int seam_rings : {4, kAllAtOnce}) {
    SeamLabels labels(plan.Blocks(), parts);
    EXPECT_GT(CutSeams(seam_rings, &labels), 100u);
  }
}

}  // namespace merged_surface_test
}  // namespace colmap_ext
