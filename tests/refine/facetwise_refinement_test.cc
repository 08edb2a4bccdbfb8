#include <algorithm>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "base/percentile.h"
#include "mesh/topology.h"
#include "photometry/photometric_energy.h"
#include "refine/facetwise_refinement.h"
#include "repair/self_intersection_repair.h"
#include "spatial/bvh.h"
#include "spatial/self_intersections.h"
#include "tests/cameras/camera_scene.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/remesh/remeshed.h"
#include "tests/threads.h"

namespace colmap_ext::facetwise_refinement_test {

const CameraScene& Scene() {
  static const CameraScene scene = MakeCameraScene();
  return scene;
}

// The truth moved along its normals by smooth waves of a pixel.
TriangleMesh PerturbedTruth() {
  const synthetic::Scene& scene = Scene().scene.dense.scene;
  TriangleMesh mesh = scene.surface;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f wave =
        (mesh.vertices[i] / (6 * scene.footprint)).array().sin();
    mesh.vertices[i] += scene.footprint * wave.sum() * scene.normals[i];
  }
  return mesh;
}

// Without views of the vertices.
RefinementStart StartOf(const TriangleMesh& mesh, int first_level = 1) {
  RefinementStart start{{mesh, {}}, first_level};
  start.attributes.views = Rows<uint32_t>(mesh.vertices.size());
  return start;
}

// Of the perturbed truth, at two levels.
struct RefineFacetwiseTest : testing::Test {
  RefineFacetwiseTest() {
    options_.levels = 2;
    options_.iterations = 6;
  }

  // By the pictures of the scene, whatever the views' scale.
  RefinedMesh Refine(RefinementStart start, const RefinementHooks& hooks = {},
                     double scale = 1) const {
    const std::vector<View> views = Scaled(Scene().scene.Views(), scale);
    start.mesh = Scaled(start.mesh, static_cast<float>(scale));
    for (Eigen::Vector3f& origin : start.origins) {
      origin *= static_cast<float>(scale);
    }
    const auto energy = MakeCpuPhotometricEnergy(
        options_.photometric, Scene().scene.PyramidOf(views), SIZE_MAX);
    return RefineFacetwise(options_, start, views,
                           Scene().scene.dense.fused.cloud, energy.get(),
                           hooks);
  }

  RefinedMesh Refine() const { return Refine(StartOf(mesh_)); }

  TriangleMesh mesh_ = PerturbedTruth();
  FacetwiseRefinementOptions options_;
};

// From the vertices that some view sees to the truth, px, median.
double MedianError(const TriangleMesh& mesh) {
  const Bvh truth(Scene().scene.Truth());
  const FacetVisibility visibility = VisibleFacets(mesh, Scene().scene.Views());
  std::vector<double> errors;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    if (visibility[i].size() >= 2) {
      errors.push_back(truth.Distance(CentroidOf(mesh, mesh.facets[i]), 1));
    }
  }
  return Median(&errors) / Scene().scene.dense.scene.footprint;
}

TEST_F(RefineFacetwiseTest, LeavesFixedVerticesAndFacetsAsTheyAre) {
  RefinementStart start = StartOf(mesh_);
  FixedVertices fixed;
  for (const Eigen::Vector3f& vertex : mesh_.vertices) {
    fixed.push_back(vertex.x() > 0 ? 1 : 0);
  }
  start.fixed_sources = SourcesOf(fixed, mesh_.vertices.size());
  start.is_part = true;
  const RefinedMesh refined = Refine(start);
  ExpectFixed(mesh_, fixed, refined.mesh, refined.fixed_sources);
  EXPECT_TRUE(Analyze(refined.mesh).IsManifold());
  const FixedVertices fixed_after = FixedOf(refined.fixed_sources);
  for (size_t i = 0; i < refined.mesh.facets.size(); ++i) {
    EXPECT_TRUE(!IsFixed(fixed_after, refined.mesh.facets[i]) ||
                refined.labels.labels[i].empty());
  }
}

// Cameras that are off by a fixed turn each, and the features that true ones
// show.
struct DisturbedCameras {
  // \param num_views  the first ones are off, the others are the true ones
  explicit DisturbedCameras(double pixels, size_t num_views = SIZE_MAX) {
    views = Scene().scene.Views();
    auto known = std::make_shared<RefinableCameras>();
    for (size_t i = 0; i < std::min(num_views, views.size()); ++i) {
      PoseStep step = PoseStep::Zero();
      step[0] = (i % 2 == 0 ? pixels : -pixels) / views[i].fx;
      step[1] = (i % 4 < 2 ? pixels : -pixels) / views[i].fx;
      views[i] = MoveView(views[i], step, IntrinsicsStep::Zero());
    }
    known->tracks = Scene().tracks;
    known->views = views;
    known->view_cameras.assign(views.size(), 0);
    known->images = Scene().scene.PyramidOf(views);
    cameras = std::move(known);
  }

  RefinedMesh Refine(const FacetwiseRefinementOptions& options,
                     const TriangleMesh& mesh) const {
    const auto energy = MakeCpuPhotometricEnergy(options.photometric,
                                                 cameras->images, SIZE_MAX);
    RefinementStart start = StartOf(mesh);
    start.cameras = cameras;
    return RefineFacetwise(options, std::move(start), views,
                           Scene().scene.dense.fused.cloud, energy.get(), {});
  }

  std::vector<View> views;
  std::shared_ptr<const RefinableCameras> cameras;
};

TEST_F(RefineFacetwiseTest, FindsTheTruthByCamerasThatAreOff) {
  const DisturbedCameras disturbed(0.5);
  options_.cameras.parts = RefinedParts::kPoses;
  const RefinedMesh refined = disturbed.Refine(options_, mesh_);
  EXPECT_LT(MedianError(refined.mesh), 0.4 * MedianError(mesh_));
  EXPECT_EQ(refined.alignment.track_positions.size(),
            disturbed.cameras->tracks.positions.size());
}

// Those that are off are refined, others left as they are.
TEST_F(RefineFacetwiseTest, RefinesCamerasWhereTheyAreMisaligned) {
  options_.cameras.parts = RefinedParts::kPoses;
  options_.cameras.only_if_misaligned = true;
  for (const double pixels : {0.0, 0.5}) {
    const DisturbedCameras disturbed(pixels);
    const RefinedMesh refined = disturbed.Refine(options_, mesh_);
    EXPECT_FALSE(refined.report.is_skipped);
    EXPECT_EQ(refined.alignment.refinements.empty(), pixels == 0);
    EXPECT_EQ(refined.alignment.track_positions.empty(), pixels == 0);
    for (size_t i = 0; i < refined.views.size(); ++i) {
      EXPECT_EQ(refined.views[i].cam_from_world_rotation ==
                    disturbed.views[i].cam_from_world_rotation,
                pixels == 0);
    }
  }
}

TEST_F(RefineFacetwiseTest, KeepsAGoodMeshFromCamerasThatAreOff) {
  const DisturbedCameras disturbed(0.5);
  const TriangleMesh& mesh = Scene().scene.Truth();
  options_.borders.trim = 0.9;
  options_.borders.close_holes = kAllLoops;
  const RefinedMesh refined = disturbed.Refine(options_, mesh);
  EXPECT_TRUE(refined.report.is_skipped);
  EXPECT_EQ(refined.mesh, mesh);
  for (size_t i = 0; i < refined.views.size(); ++i) {
    EXPECT_TRUE(refined.views[i].cam_from_world_rotation ==
                disturbed.views[i].cam_from_world_rotation);
  }
}

// One image that is off is refined, or the surface is refined without it.
TEST_F(RefineFacetwiseTest, OneImageThatIsOffDoesNoHarm) {
  const DisturbedCameras disturbed(2, 1);
  const RefinedMesh fixed = disturbed.Refine(options_, mesh_);
  EXPECT_FALSE(fixed.report.is_skipped);
  EXPECT_EQ(MisalignedViews(fixed.alignment.misalignment),
            std::vector<uint32_t>{0});
  EXPECT_LT(MedianError(fixed.mesh), 0.2 * MedianError(mesh_));
  options_.cameras.parts = RefinedParts::kPoses;
  options_.cameras.only_if_misaligned = true;
  const RefinedMesh refined = disturbed.Refine(options_, mesh_);
  EXPECT_FALSE(refined.alignment.refinements.empty());
  EXPECT_LT(MedianError(refined.mesh), 0.4 * MedianError(mesh_));
}

TEST_F(RefineFacetwiseTest, FindsTheTruthByDescentToo) {
  options_.solver = RefinementSolver::kDescent;
  options_.iterations = 12;
  EXPECT_LT(MedianError(Refine().mesh), 0.6 * MedianError(mesh_));
}

TEST_F(RefineFacetwiseTest, KeepsTheTopology) {
  options_.max_face_area = 3;
  size_t num_facets = 0;
  for (const bool remeshing : {true, false}) {
    options_.remeshing = remeshing;
    const RefinedMesh refined = Refine();
    ExpectSameTopology(mesh_, refined.mesh);
    EXPECT_EQ(refined.attributes.views.offsets.size(),
              refined.mesh.vertices.size() + 1);
    EXPECT_EQ(refined.labels.NumFacets(), refined.mesh.facets.size());
    EXPECT_EQ(refined.origins.size(), refined.mesh.vertices.size());
    EXPECT_GT(refined.mesh.facets.size(), num_facets);
    num_facets = refined.mesh.facets.size();  // more without remeshing
  }
  EXPECT_GT(num_facets, mesh_.facets.size());
}

// Those of the input are repaired where they can be, and no new ones made.
TEST_F(RefineFacetwiseTest, MakesNoSelfIntersections) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {  // spikes
    mesh_.vertices[random.Below(mesh_.vertices.size())] *= 0.7f;
  }
  const size_t num_before = FindSelfIntersections(mesh_).size();
  EXPECT_GT(num_before, 0u);
  const RefinedMesh refined = Refine();
  const RefinementReport& report = refined.report;
  EXPECT_EQ(FindSelfIntersections(refined.mesh).size(),
            report.num_self_intersections);
  EXPECT_GT(report.num_removed_self_intersections, 0u);
  EXPECT_LT(10 * report.num_self_intersections, num_before);
}

TEST_F(RefineFacetwiseTest, LowersTheEnergyFromStepToStep) {
  options_.levels = 1;
  const RefinedMesh refined = Refine(StartOf(mesh_, 0));
  const std::vector<RefinementStep>& steps = refined.report.steps;
  // Few pairs, some in the first of the final iterations, all in the last ones.
  std::vector<std::vector<RefinementStep>> stages;
  for (const RefinementStep& step : steps) {
    if (stages.empty() || stages.back().back().num_pairs != step.num_pairs) {
      stages.emplace_back();
    }
    stages.back().push_back(step);
  }
  ASSERT_EQ(stages.size(), 3);
  EXPECT_EQ(steps.front().iteration, 0);
  for (size_t k = 0; k < stages.size(); ++k) {
    const std::vector<RefinementStep>& stage = stages[k];
    ASSERT_GE(stage.size(), 2);
    EXPECT_LT(stage.back().photometric_energy,
              stage.front().photometric_energy);
    EXPECT_GT(stage.back().mean_zncc, stage.front().mean_zncc);
    for (size_t i = 0; i < stage.size(); ++i) {
      EXPECT_EQ(stage[i].iteration, stage.front().iteration + i);
      EXPECT_EQ(stage[i].level, 0);
      EXPECT_EQ(stage[i].is_final, k > 0);
    }
    if (k > 0) {
      EXPECT_EQ(stage.front().iteration, stages[k - 1].back().iteration);
      EXPECT_GT(stage.front().num_pairs, stages[k - 1].front().num_pairs);
    }
  }
}

// With final iterations at the finest level alone.
TEST_F(RefineFacetwiseTest, FindsTheTruthAgain) {
  const RefinedMesh refined = Refine();
  EXPECT_LT(MedianError(refined.mesh), 0.35 * MedianError(mesh_));
  size_t num_coarse = 0;
  for (const RefinementStep& step : refined.report.steps) {
    num_coarse += step.level > 0 ? 1 : 0;
    EXPECT_LE(step.is_final, step.level == 0);
  }
  EXPECT_GT(num_coarse, 1);
  EXPECT_TRUE(refined.report.steps.back().is_final);
}

TEST_F(RefineFacetwiseTest, DoesNotDependOnThreads) {
  ExpectSameForAnyThreads([&] {
    const RefinedMesh refined = Refine();
    return std::pair(refined.mesh, refined.attributes.confidences);
  });
}

TEST_F(RefineFacetwiseTest, StaysNearTheTruthAndIsSureOfWhatTheViewsSeeAlike) {
  const RefinedMesh refined = Refine(StartOf(Scene().scene.Truth()));
  EXPECT_LT(MedianError(refined.mesh), 0.2);
  const std::vector<float>& confidences = refined.attributes.confidences;
  ASSERT_EQ(confidences.size(), refined.mesh.vertices.size());
  const FacetVisibility visibility =
      VisibleFacets(refined.mesh, Scene().scene.Views());
  std::vector<uint8_t> is_seen(confidences.size(), 0);
  std::vector<double> seen;
  for (size_t i = 0; i < refined.mesh.facets.size(); ++i) {
    for (const uint32_t vertex : refined.mesh.facets[i]) {
      is_seen[vertex] |= visibility[i].empty() ? 0 : 1;
    }
  }
  for (size_t i = 0; i < confidences.size(); ++i) {
    ASSERT_GE(confidences[i], 0);
    ASSERT_LE(confidences[i], 1);
    if (is_seen[i] != 0) {
      seen.push_back(confidences[i]);
    } else {
      EXPECT_EQ(confidences[i], 0) << i;
    }
  }
  EXPECT_GT(Median(&seen), 0.8);
}

TEST_F(RefineFacetwiseTest, ScalesWithTheScene) {
  const RefinedMesh refined = Refine();
  for (const double scale : {1024.0, 1 / 1024.0}) {
    const TriangleMesh scaled = Refine(StartOf(mesh_), {}, scale).mesh;
    EXPECT_EQ(Scaled(scaled, static_cast<float>(1 / scale)), refined.mesh);
  }
}

TEST_F(RefineFacetwiseTest, GoesOnFromACompleteLevel) {
  RefinedMesh first;
  RefinementHooks hooks;
  hooks.on_level = [&](int level, const RefinedMesh& state) {
    if (level == 1) {
      first = state;
    }
  };
  const RefinedMesh refined = Refine(StartOf(mesh_), hooks);
  EXPECT_EQ(Refine({{first.mesh, first.attributes, first.origins}, 0}).mesh,
            refined.mesh);
}

TEST_F(RefineFacetwiseTest, StopsAtTheNextStep) {
  bool is_last = false;
  RefinementHooks hooks;
  hooks.on_level = [&](int level, const RefinedMesh& state) {
    EXPECT_EQ(level, 1);
    EXPECT_FALSE(state.mesh.vertices.empty());
    is_last = true;
  };
  int num_more = 0;
  hooks.should_stop = [&] {
    num_more += is_last ? 1 : 0;
    return is_last;
  };
  const RefinedMesh stopped = Refine(StartOf(mesh_), hooks);
  EXPECT_TRUE(stopped.report.is_stopped);
  EXPECT_EQ(num_more, 1);
}

TEST_F(RefineFacetwiseTest, TrimsWhatNoViewSeesAndClosesIt) {
  const TriangleMesh& mesh = Scene().scene.Truth();
  options_.remeshing = false;  // Facets that no view sees stay small.
  const RefinedMesh whole = Refine(StartOf(mesh));
  options_.borders.trim = 0.2;
  options_.borders.gap_pixels = 2;  // The scene is a few windows wide.
  for (const double close_holes : {0.0, kAllLoops}) {
    options_.borders.close_holes = close_holes;
    const RefinedMesh refined = Refine(StartOf(mesh));
    EXPECT_TRUE(Analyze(refined.mesh).IsManifold());
    EXPECT_GT(refined.report.borders.trim.num_facets, 0);
    EXPECT_EQ(refined.report.borders.holes.num_closed > 0, close_holes != 0);
    EXPECT_GT(refined.mesh.facets.size(), whole.mesh.facets.size() / 4);
    EXPECT_LT(
        refined.mesh.facets.size(),
        whole.mesh.facets.size() + refined.report.borders.holes.num_facets);
    const size_t num_vertices = refined.mesh.vertices.size();
    EXPECT_EQ(refined.labels.NumFacets(), refined.mesh.facets.size());
    EXPECT_EQ(refined.origins.size(), num_vertices);
    EXPECT_EQ(refined.attributes.views.size(), num_vertices);
    EXPECT_EQ(refined.attributes.confidences.size(), num_vertices);
  }
}

// Two spheres, one just inside the other, whose needles cannot be improved
// everywhere without a crossing, and a third one far away.
TEST(ImproveFacets, LeavesOnlyTheSurroundingsOfCrossingsAlone) {
  Random random(3);
  const TriangleMesh sphere = MakeThinFacets(MakeBumpySphere(0.1F), &random);
  RefinedMesh refined;
  refined.mesh =
      Union(Union(sphere, Scaled(sphere, 0.999F)), Shifted(sphere, {5, 0, 0}));
  ASSERT_EQ(RepairSelfIntersections(&refined.mesh).num_after, 0);
  refined.attributes.views = Rows<uint32_t>(refined.mesh.vertices.size());
  const double thin = ShareBelow(10, refined.mesh);
  ImproveFacets(&refined);
  EXPECT_TRUE(FindSelfIntersections(refined.mesh).empty());
  EXPECT_LT(ShareBelow(10, refined.mesh), 0.2 * thin);
}

TEST(FinishRefinement, RefusesRegionsThatLeaveNothing) {
  FacetwiseRefinementOptions options;
  options.region = RegionBetween({9, 9, 9}, {10, 10, 10});
  RefinedMesh refined;
  static_cast<Surface&>(refined) = StartOf(MakeCube());
  refined.report.is_skipped = true;
  EXPECT_THROW(FinishRefinement(options, {}, {}, &refined),
               std::invalid_argument);
}

}  // namespace colmap_ext::facetwise_refinement_test
