#include "merging/banded_mesh.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "merging/merged_surface.h"
#include "meshing/finish_surface.h"
#include "scene/look_at.h"
#include "tests/merging/merged_plan.h"
#include "tests/random.h"
#include "tests/tiles/memory_store.h"

namespace colmap_ext {
namespace {

// A cut plan whose surface is to be finished.
class FinishBandsTest : public testing::Test {
 protected:
  void Cut(const SeenScene& scene, size_t num_tiles) {
    merged_ = std::make_unique<MergedPlan>(
        scene, num_tiles,
        options_.preemptive_fixing ? std::optional(options_.fixing_rule)
                                   : std::nullopt);
    views_.clear();
    for (const Eigen::Vector3d& center : scene.centers) {
      views_.push_back(
          LookAtView(center, {0, 0, 0.1}, {0, 1, 0.01}, 1000, 800, 900));
    }
  }

  // Made up, but for the views and ends.
  TileVertices AttributesOf(const std::vector<uint32_t>& ids) const {
    TileVertices read;
    for (const uint32_t id : ids) {
      Random random(id);
      const Observations seen = merged_->plan.ReadObservations(id, id + 1);
      read.supports.push_back(
          std::accumulate(seen.alphas.begin(), seen.alphas.end(), 0.0f));
      read.colors.push_back({static_cast<uint8_t>(random.Below(256)),
                             static_cast<uint8_t>(id), 7});
      read.views.AddRow(seen.views);
      read.observations.is_end.push_back(seen.IsEnd(0));
    }
    return read;
  }

  ManifoldMesh FinishWhole() const {
    MergedSurface merged = MergeSurface(merged_->plan, merged_->Labeled(),
                                        merged_->changes.centroids());
    merged.ids.erase(std::ranges::lower_bound(
                         merged.ids, merged_->plan.Blocks().NumVertices()),
                     merged.ids.end());
    TileVertices read = AttributesOf(merged.ids);
    PointCloud cloud;
    cloud.colors = read.colors;
    cloud.views = read.views;
    std::vector<uint32_t> points(merged.ids.size());
    std::iota(points.begin(), points.end(), 0);
    ManifoldMesh result;
    SplitSurface(options_, std::move(merged.extracted),
                 {cloud, points, read.supports, read.observations.is_end},
                 views_, &result);
    FinishSurface(options_, {}, &result);
    return result;
  }

  BandedMesh Finish(ManifoldMeshingReport* report) const {
    const PlanBlocks& blocks = merged_->plan.Blocks();
    SurfaceBands bands(merged_->plan, merged_->changes.centroids(),
                       MakeMemoryStore);
    for (uint32_t tile = 0; tile < blocks.NumTiles(); ++tile) {
      bands.Add(SurfaceOf(merged_->Labeled(), blocks, tile));
    }
    bands.Finish();
    return FinishBands(
        options_, bands,
        [this](const std::vector<uint32_t>& ids) { return AttributesOf(ids); },
        views_, {}, MakeMemoryStore, report);
  }

  // All of it, to the bit and in the same order.
  void ExpectWhole(const SeenScene& scene, size_t num_tiles) {
    SCOPED_TRACE(num_tiles);
    Cut(scene, num_tiles);
    const ManifoldMesh whole = FinishWhole();
    ManifoldMeshingReport report;
    const BandedMesh banded = Finish(&report);
    const SectionedMesh& mesh = banded.mesh;
    ASSERT_EQ(mesh.NumFacets(), whole.mesh.facets.size());
    ASSERT_EQ(mesh.NumVertices(), whole.mesh.vertices.size());
    EXPECT_EQ(mesh.ReadFacets(0, mesh.NumFacets()), whole.mesh.facets);
    EXPECT_EQ(mesh.ReadPositions(0, mesh.NumVertices()), whole.mesh.vertices);
    EXPECT_EQ(banded.colors.Read(0, banded.colors.size()),
              whole.attributes.colors);
    EXPECT_EQ(banded.confidences.Read(0, banded.confidences.size()),
              whole.attributes.confidences);
    EXPECT_EQ(banded.views.Read(0, banded.views.size()),
              whole.attributes.views.values);
    ExpectSameReport(report, whole.report);
    last_ = whole.report;
  }

  static void ExpectSameReport(const ManifoldMeshingReport& a,
                               const ManifoldMeshingReport& b) {
    EXPECT_EQ(a.num_split_vertices, b.num_split_vertices);
    EXPECT_EQ(a.num_midpoints, b.num_midpoints);
    EXPECT_EQ(a.num_long_facets, b.num_long_facets);
    EXPECT_EQ(a.self_intersections.num_before, b.self_intersections.num_before);
    EXPECT_EQ(a.self_intersections.num_after, b.self_intersections.num_after);
    EXPECT_EQ(a.self_intersections.num_moved_vertices,
              b.self_intersections.num_moved_vertices);
    EXPECT_EQ(a.self_intersections.mean_motion,
              b.self_intersections.mean_motion);
    EXPECT_EQ(a.mesh.num_edges, b.mesh.num_edges);
    EXPECT_EQ(a.mesh.num_components, b.mesh.num_components);
    EXPECT_EQ(a.mesh.num_border_edges, b.mesh.num_border_edges);
    EXPECT_EQ(a.mesh.num_border_loops, b.mesh.num_border_loops);
    EXPECT_EQ(a.mesh.genus, b.mesh.genus);
  }

  ManifoldMeshingOptions options_;
  std::unique_ptr<MergedPlan> merged_;
  std::vector<View> views_;
  ManifoldMeshingReport last_;  // of the whole
};

SeenScene NoisyScene(uint64_t seed) {
  SeenScene scene = SphereScene(2000, seed, 0.1);
  scene.options.quality_regularization = 0.05;
  return scene;
}

TEST_F(FinishBandsTest, IsTheWholeSurface) {
  for (const size_t num_tiles : {1, 2, 8}) {
    ExpectWhole(SphereScene(2000, 4), num_tiles);
    ExpectWhole(GroundScene(2000, 5), num_tiles);
  }
}

TEST_F(FinishBandsTest, IsTheWholeWithSingularVerticesFixed) {
  for (const uint64_t seed : {6, 7}) {
    for (const size_t num_tiles : {1, 3, 6}) {
      ExpectWhole(NoisyScene(seed), num_tiles);
    }
  }
}

TEST_F(FinishBandsTest, IsTheWholeWithSingularVerticesSplit) {
  options_.preemptive_fixing = false;
  size_t num_midpoints = 0;
  for (const uint64_t seed : {6, 7, 8}) {
    for (const size_t num_tiles : {1, 5}) {
      ExpectWhole(NoisyScene(seed), num_tiles);
      EXPECT_GT(last_.num_split_vertices, 100u);
      EXPECT_GT(last_.self_intersections.num_before, 20u);
      num_midpoints += last_.num_midpoints;
    }
  }
  EXPECT_GT(num_midpoints, 0u);
}

TEST_F(FinishBandsTest, IsTheWholeWithoutLongFacets) {
  options_.max_side_length_factor = 1.05;
  options_.preemptive_fixing = false;
  for (const size_t num_tiles : {1, 3, 6}) {
    ExpectWhole(NoisyScene(6), num_tiles);
    EXPECT_GT(last_.num_long_facets, 100u);
  }
  options_.max_side_length_factor = 0;
  ExpectWhole(NoisyScene(6), 4);
  EXPECT_EQ(last_.num_long_facets, 0u);
}

TEST_F(FinishBandsTest, IsTheWholeWithEndsOfRays) {
  for (const size_t num_tiles : {1, 2, 5}) {
    ExpectWhole(GroundSceneWithEnds(2000, 5), num_tiles);
  }
}

TEST_F(FinishBandsTest, IsTheWholeOfARegion) {
  options_.region = RegionBetween({-0.7, -0.5, -2}, {0.7, 2, 0.6});
  for (const bool is_fixed : {true, false}) {
    options_.preemptive_fixing = is_fixed;
    for (const size_t num_tiles : {1, 3, 6}) {
      ExpectWhole(NoisyScene(6), num_tiles);
      EXPECT_GT(last_.mesh.num_border_edges, 20u);
    }
  }
}

TEST_F(FinishBandsTest, DoesNotDependOnThreads) {
  Cut(NoisyScene(6), 4);
  ManifoldMeshingReport report;
  const BandedMesh many = Finish(&report);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);
  const BandedMesh single = Finish(&report);
  const uint32_t num_vertices = many.mesh.NumVertices();
  ASSERT_EQ(single.mesh.NumVertices(), num_vertices);
  EXPECT_EQ(single.mesh.ReadPositions(0, num_vertices),
            many.mesh.ReadPositions(0, num_vertices));
  EXPECT_EQ(single.mesh.ReadFacets(0, single.mesh.NumFacets()),
            many.mesh.ReadFacets(0, many.mesh.NumFacets()));
  EXPECT_EQ(single.confidences.Read(0, num_vertices),
            many.confidences.Read(0, num_vertices));
}

TEST_F(FinishBandsTest, RefusesARegionThatLeavesNothing) {
  options_.region = RegionBetween({7, 7, 7}, {8, 8, 8});
  Cut(SphereScene(1000, 4), 2);
  ManifoldMeshingReport report;
  EXPECT_THROW(Finish(&report), std::invalid_argument);
}

TEST(NeedsWholeSurface, NamesTheOption) {
  ManifoldMeshingOptions options;
  EXPECT_EQ(NeedsWholeSurface(options), "");
  options.min_component_faces = 2;
  EXPECT_EQ(NeedsWholeSurface(options), "min_component_faces");
  options.remeshing = true;
  EXPECT_EQ(NeedsWholeSurface(options), "remeshing");
  options.borders.close_holes = kAllLoops;
  EXPECT_EQ(NeedsWholeSurface(options), "close_holes");
  options.borders.trim = 0.5;
  EXPECT_EQ(NeedsWholeSurface(options), "trim");
}

}  // namespace
}  // namespace colmap_ext
