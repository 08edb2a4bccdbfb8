#include "tests/synthetic/dense_scene.h"

#include <stdexcept>
#include <utility>

#include "spatial/bvh.h"

namespace colmap_ext::synthetic {

std::string DenseSceneOptions::Check() const {
  if (const std::string error = scene.Check(); !error.empty()) {
    return error;
  }
  if (const std::string error = stereo.Check(); !error.empty()) {
    return error;
  }
  if (!(render.sensor_noise >= 0 && render.sensor_noise <= 100 &&
        render.photon_noise >= 0 && render.photon_noise <= 100)) {
    return "sensor_noise and photon_noise must be in [0, 100]";
  }
  if (const std::string error = pose_noise.Check(); !error.empty()) {
    return error;
  }
  if (!(fusion.outliers >= 0 && fusion.outliers <= 1)) {
    return "outliers must be in [0, 1]";
  }
  if (fusion.min_num_pixels < 1) {
    return "min_num_pixels must be positive";
  }
  if (sparse.num_points < 0) {
    return "num_sparse_points must not be negative";
  }
  if (!(sparse.noise >= 0 && sparse.noise <= 10)) {
    return "feature_noise must be in [0, 10]";
  }
  return "";
}

DenseScene MakeDenseScene(const DenseSceneOptions& options) {
  if (const std::string error = options.Check(); !error.empty()) {
    throw std::invalid_argument(error);
  }
  const uint64_t seed = options.scene.seed;
  const int num_threads = options.scene.num_threads;
  DenseScene result;
  result.scene = MakeScene(options.scene);
  const Scene& scene = result.scene;
  const Bvh bvh(scene.surface);
  std::vector<Visible> visible;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    visible.push_back(RenderVisible(bvh, scene.views[i], num_threads));
    if (options.render_images) {
      result.images.push_back(
          RenderImage(scene, bvh, i, options.render, seed, num_threads));
    }
  }
  std::vector<DepthMap> maps;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    maps.push_back(
        SimulateStereo(scene, visible, i, options.stereo, seed, num_threads));
  }
  result.model_views = DisturbViews(options.pose_noise, scene.views,
                                    scene.footprint * scene.views[0].fx, seed);
  const std::vector<View>& fusing =
      options.pose_noise.is_before_fusion ? result.model_views : scene.views;
  result.fused = FuseDepthMaps(fusing, maps, result.images, options.fusion);
  AddOutliers(fusing, options.fusion.outliers, seed, &result.fused);
  result.sparse_points =
      MakeSparsePoints(scene, visible, result.images, options.sparse, seed);
  if (options.keep_depth_maps) {
    result.depth_maps = std::move(maps);
  }
  if (options.keep_true_depths) {
    result.visible = std::move(visible);
  }
  return result;
}

}  // namespace colmap_ext::synthetic
