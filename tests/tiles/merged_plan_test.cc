#include "tiles/merged_plan.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "delaunay/visibility_weights.h"
#include "mesh/split_fans.h"
#include "mesh/topology.h"
#include "meshing/singular_vertices.h"
#include "tests/mesh/known_meshes.h"
#include "tests/tiles/scene_plans.h"
#include "tiles/patch_cells.h"

namespace colmap_ext::merged_plan_test {

// The surface of all vertices on one machine.
TriangleMesh SurfaceOfWhole(const SeenScene& scene, const MemoryPlan& plan,
                            bool is_fixed) {
  WholeCut whole(scene, plan);
  if (is_fixed) {
    FixSingularVertices(FixingRule::kEnergy, &whole.tetrahedra, &whole.graph,
                        &whole.labels);
  }
  const ExtractedSurface extracted =
      ExtractSurface(whole.tetrahedra, whole.labels);
  return SplitFans(extracted.mesh, extracted.partners).mesh;
}

TriangleMesh SurfaceOfPlan(const MergedPlan& merged) {
  const ExtractedSurface extracted = MergeSurface(merged.changes).extracted;
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
  EXPECT_TRUE(TrianglesOf(merged) == TrianglesOf(whole));
}

size_t NumSingular(const SeenScene& scene) {
  const WholeCut whole(scene, PlanOf(scene, 1));
  return SingularVertices(whole.tetrahedra, whole.labels).size();
}

// Noise that leaves many singular vertices.
SeenScene NoisyScene(uint64_t seed) {
  SeenScene scene = SphereScene(3000, seed, 0.1);
  scene.options.quality_regularization = 0.05;
  scene.options.seam_rings = 4;
  return scene;
}

TEST(MergeSurface, IsThatOfOneMachineAlsoOnALattice) {
  for (const size_t num_tiles : {1, 2, 4, 8}) {
    ExpectSameSurface(SphereScene(3000, 4), num_tiles, false);
    ExpectSameSurface(GroundScene(4000, 5), num_tiles, false);
  }
  ExpectSameSurface(LatticeScene(1), 8, true);
  ExpectSameSurface(BoxScene(1 / 150.0f), 2, false);
}

TEST(MergeSurface, IsThatOfOneMachineWithSingularVerticesFixed) {
  for (const uint64_t seed : {6, 7, 8}) {
    SeenScene scene = NoisyScene(seed);
    scene.options.seam_rings = kAllAtOnce;
    EXPECT_GT(NumSingular(scene), 100u);
    for (const size_t num_tiles : {1, 3, 6}) {
      ExpectSameSurface(scene, num_tiles, true);
    }
  }
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
    const TilePart part = merged.changes.ReadPart(tile);
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
      EXPECT_EQ(merged.report.num_split_cells, merged.changes.NumCentroids());
    }
    EXPECT_GT(num_raw, 300u);
    EXPECT_GT(num_split, 0u);
    EXPECT_LT(num_left, num_raw / 3);
  }
}

TEST(FixPlan, LeavesNoMoreThanOneMachine) {
  const auto num_left = [](int seam_rings) {
    size_t count = 0;
    for (const uint64_t seed : {6, 7, 8}) {
      SeenScene scene = NoisyScene(seed);
      scene.options.seam_rings = seam_rings;
      count +=
          MergedPlan(scene, 6, FixingRule::kEnergy).report.num_singular_fixed;
    }
    return count;
  };
  EXPECT_LE(num_left(4), 1.25 * static_cast<double>(num_left(kAllAtOnce)));
}

// Each facet of a tile's own and each of the neighbors' at it, from both tiles.
TEST(SurfaceOf, TilesAgreeOnWhatFixingHasChanged) {
  const MergedPlan merged(NoisyScene(6), 6, FixingRule::kEnergy);
  std::multiset<Facet> facets;
  for (uint32_t tile = 0; tile < 6; ++tile) {
    const TileSurface surface = SurfaceOf(merged.changes, tile);
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
  const WholeCut whole(scene, merged.plan);
  const std::map<CellKey, uint32_t> cells = whole.CellsByKey();
  std::vector<uint8_t> labels(whole.labels.size(), kNotKnown);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    const TilePart part = merged.changes.ReadPart(tile);
    for (uint32_t cell = 0; cell < part.labels.size(); ++cell) {
      if (part.tile.IsStarCell(cell)) {
        uint8_t& label = labels[cells.at(Sorted(part.tile.CornersOf(cell)))];
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
  const MemoryPlan plan = PlanOf(scene, 4);
  MemoryParts parts(scene, plan);
  SeamLabels told(plan, parts);
  CutSeams(scene.options.seam_rings, &told);
  for (uint32_t tile = 0; tile < 4; ++tile) {
    TileSeam seam = parts.ReadSeam(tile);
    for (UnknownCell& cell : seam.unknown) {
      cell.guess = kFreeSpace;
    }
    parts.SetSeam(tile, seam);
  }
  SeamLabels guessed(plan, parts);
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
  const MemoryPlan plan = PlanOf(scene, 3);
  SeenScene other = scene;
  other.options.rays.distance_sigma = 0.1;
  MemoryParts parts(scene, plan);
  for (const int seam_rings : {4, kAllAtOnce}) {
    SeamLabels labels(plan, parts);
    EXPECT_EQ(CutSeams(seam_rings, &labels), 0u);
  }
  parts.SetSeam(1, MemoryParts(other, plan).ReadSeam(1));
  for (const int seam_rings : {4, kAllAtOnce}) {
    SeamLabels labels(plan, parts);
    EXPECT_GT(CutSeams(seam_rings, &labels), 100u);
  }
}

// More cells than a block has.
TEST(TileWindow, ShowsTheCellsOfAPart) {
  const MergedPlan merged(GroundScene(4000, 3), 3);
  const MemoryParts& parts = merged.parts;
  size_t num_at_seams = 0;
  for (uint32_t tile = 0; tile < 3; ++tile) {
    const TilePart part = parts.ReadPart(tile);
    const std::vector<uint8_t> labels = merged.seam.ReadPart(tile).labels;
    TileWindow window(merged.seam, tile);
    std::vector<uint32_t> expected;
    std::vector<uint32_t> cells;
    for (uint32_t vertex = 0; vertex < part.tile.num_own; ++vertex) {
      IncidentCells(part.tile.tetrahedra, vertex, &expected);
      window.CellsAt(vertex, &cells);
      ASSERT_EQ(cells, expected);
      for (const uint32_t cell : cells) {
        ASSERT_EQ(window.CornersOf(cell), part.tile.CornersOf(cell));
        ASSERT_EQ(window.LabelOf(cell), labels[cell]);
        num_at_seams += part.labels[cell] == kNotKnown;
        ASSERT_EQ(window.CapacitiesOf(cell),
                  parts.ReadCells(tile, cell, cell + 1).graph[0]);
      }
    }
  }
  EXPECT_GT(num_at_seams, 100u);
}

TEST(AddTile, RefusesMoreVerticesThanCanBeNumbered) {
  const std::vector<Eigen::Vector3f> positions(10, Eigen::Vector3f::Zero());
  Observations observations;
  observations.offsets.assign(positions.size() + 1, 0);
  const auto num_vertices = static_cast<uint32_t>(positions.size());
  for (const uint32_t missing : {0u, 1u, num_vertices - 1}) {
    PlanBlocks blocks;
    blocks.begins = {0, UINT32_MAX - missing};
    EXPECT_THROW(AddTile(positions, observations, &blocks),
                 std::invalid_argument);
    EXPECT_EQ(blocks.NumVertices(), UINT32_MAX - missing);
    EXPECT_EQ(blocks.NumTiles(), 0u);
  }
  PlanBlocks blocks;
  blocks.begins = {0, UINT32_MAX - num_vertices};
  AddTile(positions, observations, &blocks);
  EXPECT_EQ(blocks.NumVertices(), UINT32_MAX);
  EXPECT_EQ(blocks.NumTiles(), 1u);
}

}  // namespace colmap_ext::merged_plan_test
