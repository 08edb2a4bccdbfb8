#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "base/indices.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

constexpr const char* kChanged = ": it has changed since it was read";

// See CameraSet::leaders.
// \param view_indices  by image_id
std::vector<uint32_t> LeadersOf(
    const SparseModel& model,
    const std::map<uint32_t, uint32_t>& view_indices) {
  std::vector<uint32_t> leaders = Iota(view_indices.size());
  bool has_rigs = false;
  for (const SparseFrame& frame : model.frames) {
    uint32_t leader = kNone;
    for (const uint32_t image_id : frame.image_ids) {
      const auto it = view_indices.find(image_id);
      if (it != view_indices.end()) {
        leader = leader == kNone ? it->second : leader;
        leaders[it->second] = leader;
        has_rigs = has_rigs || it->second != leader;
      }
    }
  }
  return has_rigs ? leaders : std::vector<uint32_t>();
}

// Moves a frame of a rig as the image moves to a view's pose.
void MoveFrame(const SparseImage& image, const View& view, SparseFrame* frame) {
  Eigen::Quaterniond& q = frame->rig_from_world_rotation;
  const Eigen::Quaterniond rig_from_cam =
      q * image.cam_from_world_rotation.conjugate();
  frame->rig_from_world_translation +=
      rig_from_cam *
      (view.cam_from_world_translation - image.cam_from_world_translation);
  q = (rig_from_cam * Eigen::Quaterniond(view.cam_from_world_rotation))
          .normalized();
}

// [views] The index of each view's image in the model.
std::vector<size_t> ImagesOf(const std::vector<View>& views,
                             const SparseModel& model, const fs::path& path) {
  std::vector<size_t> of_views;
  for (const View& view : views) {
    const auto found =
        std::ranges::find(model.images, view.name, &SparseImage::name);
    if (found == model.images.end()) {
      throw FileError(path, "has no image " + view.name + kChanged);
    }
    of_views.push_back(static_cast<size_t>(found - model.images.begin()));
  }
  return of_views;
}

}  // namespace

std::shared_ptr<const RefinableCameras> ReadRefinableCameras(
    const fs::path& path, const std::vector<View>& views,
    std::shared_ptr<ImagePyramid> images) {
  const SparseModel model = ReadSparseModel(path, SparseDetail::kAll);
  const std::vector<size_t> order = ImagesOf(views, model, path);
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
  cameras->leaders = LeadersOf(model, view_indices);
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
      const Eigen::Vector2d scale(1.0 * view.width / camera.width,
                                  1.0 * view.height / camera.height);
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

void WriteRefinedCameras(const fs::path& folder, RefinedParts parts,
                         const fs::path& path, const std::vector<View>& views,
                         const std::vector<Eigen::Vector3d>& positions) {
  SparseModel model = ReadSparseModel(path, SparseDetail::kAll);
  const std::vector<size_t> order = ImagesOf(views, model, path);
  if (positions.size() != model.exact_positions.size()) {
    throw FileError(path, std::string("has other points") + kChanged);
  }
  std::map<uint32_t, size_t> view_indices;  // by image_id
  for (size_t i = 0; i < order.size(); ++i) {
    view_indices[model.images[order[i]].image_id] = i;
  }
  for (SparseFrame& frame : model.frames) {
    for (const uint32_t image_id : frame.image_ids) {
      const auto it = view_indices.find(image_id);
      if (it != view_indices.end()) {
        MoveFrame(model.images[order[it->second]], views[it->second], &frame);
        break;
      }
    }
  }
  for (size_t i = 0; i < order.size(); ++i) {
    const View& view = views[i];
    SparseImage& image = model.images[order[i]];
    image.cam_from_world_rotation =
        Eigen::Quaterniond(view.cam_from_world_rotation).normalized();
    image.cam_from_world_translation = view.cam_from_world_translation;
    if (parts == RefinedParts::kPosesIntrinsics) {
      SparseCamera& camera = model.cameras.at(image.camera_id);
      const View full = ResizeView(view, static_cast<int>(camera.width),
                                   static_cast<int>(camera.height));
      camera.fx = full.fx;
      camera.fy = full.fy;
      camera.cx = full.cx;
      camera.cy = full.cy;
    }
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    model.exact_positions[i] = positions[i];
    model.point_positions[i] = positions[i].cast<float>();
  }
  WriteSparseModel(folder, model);
}

}  // namespace colmap_ext
