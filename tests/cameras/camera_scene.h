#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "cameras/refine_cameras.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {

// A statue rendered by known cameras, and its features, as a refinement of
// cameras takes them.
struct CameraScene {
  RefinementScene scene;
  CameraSet truth;
  SparseTracks tracks;  // observed by the true cameras
  std::vector<ViewPair> pairs;

  // Refines cameras at level 0 on the true surface.
  RefinedCameras Refine(const CameraRefinementOptions& options,
                        const CameraSet& start,
                        const SparseTracks& used) const {
    const PhotometricOptions photometric;
    const std::shared_ptr<ImagePyramid> images = scene.Pyramid();
    const VisibilityBuffers buffers(scene.Truth(), start.views,
                                    photometric.min_cosine, SIZE_MAX);
    return RefineCameras(options,
                         {photometric, used, buffers, pairs, images.get()},
                         start, start);
  }
};

// \param with_own_cameras  each view has a camera of its own.
// \param width  of the images, px.
inline CameraScene MakeCameraScene(bool with_own_cameras = false,
                                   int width = 160) {
  CameraScene result{MakeRefinementScene("statue", 8, width), {}, {}, {}};
  const synthetic::DenseScene& dense = result.scene.dense;
  result.truth.views = result.scene.Views();
  for (size_t i = 0; i < result.truth.views.size(); ++i) {
    result.truth.view_cameras.push_back(
        with_own_cameras ? static_cast<uint32_t>(i) : 0);
  }
  for (const synthetic::SparsePoint& point : dense.sparse_points) {
    result.tracks.positions.push_back(point.position);
    for (const synthetic::Feature& feature : point.track) {
      result.tracks.observations.values.push_back(
          {feature.view, feature.position});
    }
    result.tracks.observations.EndRow();
  }
  result.pairs = SelectViewPairs(dense.fused.cloud, result.truth.views.size(),
                                 static_cast<int>(result.truth.views.size()));
  return result;
}

// How far the tracks' true points move in the views that see them, from one set
// of cameras to another: RMS, px.
// \param view  of this alone; -1 of all.
inline double Distance(const CameraScene& scene, const CameraSet& a,
                       const CameraSet& b, int view = -1) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < scene.tracks.positions.size(); ++i) {
    for (const TrackObservation& seen : scene.tracks.observations[i]) {
      if (view >= 0 && seen.view != static_cast<uint32_t>(view)) {
        continue;
      }
      const View& view_a = a.views[seen.view];
      const View& view_b = b.views[seen.view];
      const Eigen::Vector3d& point = scene.tracks.positions[i];
      sum += (view_a.ImageFromCam(view_a.CamFromWorld(point)) -
              view_b.ImageFromCam(view_b.CamFromWorld(point)))
                 .squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

// The cameras turned and moved at random, so that what they see moves by about
// so many px, RMS.
inline CameraSet Disturb(const CameraScene& scene, const CameraSet& cameras,
                         double pixels, uint64_t seed) {
  Random random(seed);
  CameraSet steps = cameras;
  for (View& view : steps.views) {
    const double depth = view.cam_from_world_translation.norm();
    PoseStep step;
    for (int k = 0; k < 6; ++k) {
      step[k] = (random.Unit() - 0.5) * (k < 3 ? 1 : depth) / view.fx;
    }
    view = MoveView(view, step, IntrinsicsStep::Zero());
  }
  const double scale = pixels / Distance(scene, cameras, steps);
  for (size_t i = 0; i < steps.views.size(); ++i) {
    steps.views[i] = MoveView(
        cameras.views[i], scale * StepBetween(cameras.views[i], steps.views[i]),
        IntrinsicsStep::Zero());
  }
  return steps;
}

}  // namespace colmap_ext
