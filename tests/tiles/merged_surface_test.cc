#include "tiles/merged_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "delaunay/cell_graph.h"
#include "mesh/fan_split.h"
#include "mesh/topology.h"
#include "meshing/singular_vertices.h"
#include "tests/tiles/memory_parts.h"

namespace colmap_ext {
namespace {

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
    EXPECT_GT(SingularVertices(whole.tetrahedra, whole.labels).size(), 100u);
    FixSingularVertices(FixingRule::kEnergy, &whole.tetrahedra, &whole.graph,
                        &whole.labels);
  }
  const ExtractedSurface extracted =
      ExtractSurface(whole.tetrahedra, whole.labels);
  return SplitFans(extracted.mesh, extracted.partners).mesh;
}

TriangleMesh MergeAll(const MemoryPlan& plan, const MemoryParts& parts,
                      bool is_fixed) {
  const SeamLabels seam = CutSeams(parts.seams());
  const SingularPatch patch =
      is_fixed ? FixPatches(plan, parts, seam, FixingRule::kEnergy)
               : SingularPatch();
  const MergedSurface merged = MergeSurface(plan, parts, seam, patch);
  return SplitFans(merged.extracted.mesh, merged.extracted.partners).mesh;
}

void ExpectSameSurface(const SeenScene& scene, size_t num_tiles,
                       bool is_fixed) {
  SCOPED_TRACE(num_tiles);
  const MemoryPlan plan = PlanOf(scene.points, num_tiles, scene.observations);
  const MemoryParts parts(scene, plan);
  const TriangleMesh merged = MergeAll(plan, parts, is_fixed);
  const TriangleMesh whole = SurfaceOfWhole(scene, plan, is_fixed);
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
    for (const size_t num_tiles : {1, 3, 6}) {
      ExpectSameSurface(scene, num_tiles, true);
    }
  }
}

// What the cut of a merged plan costs over that of one machine, as a share.
double ExtraEnergy(const SeenScene& scene, size_t num_tiles) {
  const MemoryPlan plan = PlanOf(scene.points, num_tiles, scene.observations);
  const MemoryParts parts(scene, plan);
  const SeamLabels seam = CutSeams(parts.seams());
  const WholeCut whole = CutWhole(scene, plan);
  const std::map<CellKey, uint32_t> cells = CellsByKey(whole);
  std::vector<uint8_t> labels(whole.labels.size(), kNotKnown);
  for (uint32_t tile = 0; tile < num_tiles; ++tile) {
    const auto part = parts.ReadPart(tile);
    std::vector<uint8_t> of_tile = part->labels;
    ApplySeamLabels(seam, part->tile, &of_tile);
    for (uint32_t cell = 0; cell < of_tile.size(); ++cell) {
      if (part->tile.IsStarCell(cell)) {
        uint8_t& label = labels[cells.at(
            KeyOf(part->tile.tetrahedra.cells[cell], part->tile.ids))];
        EXPECT_TRUE(label == kNotKnown || label == of_tile[cell]);
        label = of_tile[cell];
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
  scene.options.seam_rings = -1;
  EXPECT_EQ(ExtraEnergy(scene, 4), 0);
}

TEST(CutSeams, DoesNotDependOnTheOrderOfTiles) {
  const SeenScene scene = SphereScene(2000, 10);
  const MemoryPlan plan = PlanOf(scene.points, 3, scene.observations);
  const MemoryParts parts(scene, plan);
  std::vector<TileSeam> seams = parts.seams();
  const SeamLabels forward = CutSeams(seams);
  std::ranges::reverse(seams);
  const SeamLabels backward = CutSeams(seams);
  EXPECT_GT(forward.labels.size(), 0u);
  EXPECT_EQ(forward.labels, backward.labels);
  EXPECT_EQ(forward.flow, backward.flow);
}

TEST(CutSeams, NoticesTilesOfDifferentPlans) {
  const SeenScene scene = SphereScene(2000, 10);
  const MemoryPlan plan = PlanOf(scene.points, 3, scene.observations);
  SeenScene other = scene;
  other.options.rays.distance_sigma = 0.1;
  std::vector<TileSeam> seams = MemoryParts(scene, plan).seams();
  seams[1] = MemoryParts(other, plan).seams()[1];
  EXPECT_THROW(CutSeams(seams), std::logic_error);
}

}  // namespace
}  // namespace colmap_ext
