#include "tests/cameras/camera_scene.h"

#include <cmath>

#include "tests/random.h"

namespace colmap_ext {

RefinedCameras CameraScene::Refine(const CameraRefinementOptions& options,
                                   const CameraSet& start,
                                   const SparseTracks& used) const {
  const PhotometricOptions photometric;
  const std::shared_ptr<ImagePyramid> images = scene.Pyramid();
  const VisibilityBuffers buffers(scene.Truth(), start.views,
                                  photometric.min_cosine, SIZE_MAX);
  return RefineCameras(
      options, {photometric, used, buffers, pairs, images.get()}, start, start);
}

CameraScene MakeCameraScene(bool with_own_cameras, int width) {
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

CameraSet Disturb(const CameraScene& scene, const CameraSet& cameras,
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

double Distance(const CameraScene& scene, const CameraSet& a,
                const CameraSet& b, int view) {
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

}  // namespace colmap_ext
