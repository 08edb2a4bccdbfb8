#include "colmap_ext/jobs/refinement_input.h"

#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/Geometry>

namespace colmap_ext {

std::shared_ptr<const RefinableCameras> MakeRefinableCameras(
    const SparseModel& model, const std::vector<size_t>& order,
    const std::vector<View>& views, std::shared_ptr<ImagePyramid> images) {
  auto cameras = std::make_shared<RefinableCameras>();
  cameras->views = views;
  cameras->images = std::move(images);
  std::map<uint32_t, uint32_t> camera_indices;  // by camera_id
  std::map<uint32_t, uint32_t> view_indices;    // by image_id
  for (size_t i = 0; i < order.size(); ++i) {
    const SparseImage& image = model.images[order[i]];
    view_indices[image.image_id] = static_cast<uint32_t>(i);
    cameras->view_cameras.push_back(
        camera_indices
            .emplace(image.camera_id,
                     static_cast<uint32_t>(camera_indices.size()))
            .first->second);
  }
  SparseTracks& tracks = cameras->tracks;
  for (size_t i = 0; i < model.exact_positions.size(); ++i) {
    for (uint64_t k = model.track_image_ids.offsets[i];
         k < model.track_image_ids.offsets[i + 1]; ++k) {
      const auto it = view_indices.find(model.track_image_ids.values[k]);
      if (it == view_indices.end() || !model.exact_positions[i].allFinite()) {
        continue;
      }
      const SparseImage& image = model.images[order[it->second]];
      if (model.track_observations[k] >= image.observations.size()) {
        continue;  // observations are left out of some models
      }
      const SparseCamera& camera = model.cameras.at(image.camera_id);
      const View& view = views[it->second];
      const Eigen::Vector2d scale(
          view.width / static_cast<double>(camera.width),
          view.height / static_cast<double>(camera.height));
      const Eigen::Vector2d& pixel =
          image.observations[model.track_observations[k]].pixel;
      if (pixel.allFinite()) {
        tracks.observations.values.push_back(
            {it->second, pixel.cwiseProduct(scale)});
      }
    }
    tracks.observations.EndRow();
    tracks.positions.push_back(model.exact_positions[i]);
  }
  return cameras;
}

SparseModel WithRefinedCameras(SparseModel model,
                               const std::vector<size_t>& order,
                               const std::vector<View>& views,
                               bool has_intrinsics,
                               const std::vector<Eigen::Vector3d>& positions) {
  for (size_t i = 0; i < order.size(); ++i) {
    const View& view = views[i];
    SparseImage& image = model.images[order[i]];
    image.cam_from_world_rotation =
        Eigen::Quaterniond(view.cam_from_world_rotation).normalized();
    image.cam_from_world_translation = view.cam_from_world_translation;
    if (has_intrinsics) {
      SparseCamera& camera = model.cameras.at(image.camera_id);
      const double scale_x = static_cast<double>(camera.width) / view.width;
      const double scale_y = static_cast<double>(camera.height) / view.height;
      camera.fx = view.fx * scale_x;
      camera.fy = view.fy * scale_y;
      camera.cx = view.cx * scale_x;
      camera.cy = view.cy * scale_y;
    }
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    model.exact_positions[i] = positions[i];
    model.point_positions[i] = positions[i].cast<float>();
  }
  return model;
}

}  // namespace colmap_ext
