#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/percentile.h"
#include "cameras/refine_cameras.h"
#include "gl/gl_photometric_energy.h"
#include "photometry/photometric_energy.h"
#include "refine/facetwise_refinement.h"
#include "tests/cameras/camera_scene.h"
#include "tests/gl/gl_test.h"
#include "tests/texts.h"

namespace colmap_ext::gl_cameras_test {

const CameraScene& Scene() {
  static const CameraScene scene = MakeCameraScene(false, 120);
  return scene;
}

const CameraSet& DisturbedCameras() {
  static const CameraSet cameras = Disturb(Scene(), Scene().truth, 0.5, 1);
  return cameras;
}

// Counts how often each view is drawn by the processor: as no memory keeps
// masks, each drawing asks for one.
struct CountedDrawings {
  std::vector<std::atomic<int>> counts =
      std::vector<std::atomic<int>>(Scene().truth.views.size());
  std::shared_ptr<ImagePyramid> images = std::make_shared<ImagePyramid>(
      DisturbedCameras().views,
      [](size_t view) { return Scene().scene.images[view]; }, 0,
      [this](size_t view) {
        ++counts[view];
        return GrayImage();  // no mask
      });

  bool AreAll(int count) const {
    return std::ranges::all_of(
        counts, [&](const auto& of_view) { return of_view == count; });
  }
};

class GlCamerasTest : public GlTest {};

TEST_F(GlCamerasTest, EachViewIsDrawnOnceAPass) {
  CountedDrawings drawn;
  const auto energy = MakeGlPhotometricEnergy({}, drawn.images, {});
  const CameraScene& scene = Scene();
  const TriangleMesh& mesh = scene.scene.Truth();
  CameraSet cameras = DisturbedCameras();
  CameraRefinementOptions options;
  options.parts = RefinedParts::kPoses;
  const PhotometricOptions photometric;
  const auto input = [&] {
    return CameraInput{photometric, scene.tracks, *energy->Visibility(mesh),
                       scene.pairs, drawn.images.get()};
  };
  energy->SetLevel(1);
  MeasureMisalignment({}, input(), cameras);
  EXPECT_TRUE(drawn.AreAll(1));
  EXPECT_EQ(energy->Visibility(mesh), energy->Visibility(mesh));
  for (const int pass : {2, 3}) {
    energy->SetViews(cameras.views);
    cameras = RefineCameras(options, input(), cameras, cameras).cameras;
    EXPECT_TRUE(drawn.AreAll(pass));
  }
}

RefinedMesh Refine(PhotometricEnergy* energy,
                   const std::shared_ptr<ImagePyramid>& images,
                   const RefinementHooks& hooks = {}) {
  const CameraScene& scene = Scene();
  FacetwiseRefinementOptions options;
  options.levels = 2;
  options.iterations = 2;
  options.remeshing = false;
  options.labeling.final_pairs_per_facet = 0;
  options.cameras.parts = RefinedParts::kPoses;
  const auto cameras = std::make_shared<RefinableCameras>(
      RefinableCameras{DisturbedCameras(), scene.tracks, images});
  VertexAttributes attributes;
  attributes.views = Rows<uint32_t>(scene.scene.Truth().vertices.size());
  return RefineFacetwise(
      options,
      {{scene.scene.Truth(), attributes}, options.levels - 1, true, cameras},
      cameras->views, scene.scene.dense.fused.cloud, energy, hooks);
}

// Of the median vertex, pixels.
double MedianDistance(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<double> distances;
  for (size_t i = 0; i < a.vertices.size(); ++i) {
    distances.push_back((a.vertices[i] - b.vertices[i]).norm());
  }
  return Median(&distances) / Scene().scene.dense.scene.footprint;
}

void ExpectAgreement(const RefinedMesh& refined, const RefinedMesh& reference) {
  const CameraScene& scene = Scene();
  const CameraSet cameras = {refined.views, scene.truth.view_cameras};
  const CameraSet expected = {reference.views, scene.truth.view_cameras};
  EXPECT_LT(Distance(scene, expected, scene.truth),
            0.5 * Distance(scene, DisturbedCameras(), scene.truth));
  EXPECT_LT(Distance(scene, cameras, expected), 0.01);
  EXPECT_EQ(refined.alignment.refinements.size(),
            reference.alignment.refinements.size());
  ASSERT_EQ(refined.mesh.facets, reference.mesh.facets);
  EXPECT_LT(MedianDistance(refined.mesh, reference.mesh), 0.01);
}

const RefinedMesh& RefinedByProcessor() {
  static const RefinedMesh refined = [] {
    const auto images = Scene().scene.Pyramid();
    return Refine(MakeCpuPhotometricEnergy({}, images, SIZE_MAX).get(), images);
  }();
  return refined;
}

TEST_F(GlCamerasTest, RefinementAgreesWithTheProcessor) {
  const auto images = Scene().scene.Pyramid();
  ExpectAgreement(Refine(MakeGlPhotometricEnergy({}, images, {}).get(), images),
                  RefinedByProcessor());
}

// Room for the coarse level alone.
TEST_F(GlCamerasTest, RefinementGoesOnByTheProcessorWhereTheCardRunsOut) {
  std::vector<std::string> warnings;
  GlOptions gl;
  gl.warn = [&](const std::string& warning) { warnings.push_back(warning); };
  gl.limits.max_memory = 1'100'000;
  const auto images = Scene().scene.Pyramid();
  const auto energy = MakeGlPhotometricEnergy({}, images, gl);
  RefinementHooks hooks;
  hooks.on_level = [&](int level, const RefinedMesh&) {
    EXPECT_EQ(warnings.size(), level == 1 ? 0 : 1);
  };
  ExpectAgreement(Refine(energy.get(), images, hooks), RefinedByProcessor());
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_TRUE(Has(warnings[0], "the processor computes the rest"));
  EXPECT_TRUE(energy->Description().starts_with("CPU, "));
}

}  // namespace colmap_ext::gl_cameras_test
