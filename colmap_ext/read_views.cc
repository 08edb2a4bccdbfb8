#include "colmap_ext/read_views.h"

#include <cmath>
#include <optional>
#include <string>

#include "colmap_ext/byte_reader.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/image_size.h"
#include "colmap_ext/read_depth_map.h"

namespace colmap_ext {

namespace {

View MakeView(const SparseImage& image, const SparseCamera& camera) {
  View view;
  view.name = image.name;
  view.width = static_cast<int>(camera.width);
  view.height = static_cast<int>(camera.height);
  view.fx = camera.fx;
  view.fy = camera.fy;
  view.cx = camera.cx;
  view.cy = camera.cy;
  view.cam_from_world_rotation =
      image.cam_from_world_rotation.toRotationMatrix();
  view.cam_from_world_translation = image.cam_from_world_translation;
  return view;
}

// \return whether the sizes differ.
bool ScaleToPicture(const ImageSize& size, const std::filesystem::path& path,
                    View* view) {
  if (size.width == view->width && size.height == view->height) {
    return false;
  }
  const double scale_x = 1.0 * size.width / view->width;
  const double scale_y = 1.0 * size.height / view->height;
  if (std::abs(view->height * scale_x - size.height) > 1 &&
      std::abs(view->width * scale_y - size.width) > 1) {
    throw FileError(
        path, "is " + std::to_string(size.width) + " x " +
                  std::to_string(size.height) + " pixels, but its camera is " +
                  std::to_string(view->width) + " x " +
                  std::to_string(view->height) +
                  ", which is not the same picture scaled; run `colmap "
                  "image_undistorter` again");
  }
  view->width = size.width;
  view->height = size.height;
  view->fx *= scale_x;
  view->cx *= scale_x;
  view->fy *= scale_y;
  view->cy *= scale_y;
  return true;
}

double ReadDepthMapScale(const std::filesystem::path& dense_path,
                         const View& view) {
  const std::filesystem::path path =
      FindDepthMap(dense_path / "stereo" / "depth_maps", view.name);
  if (path.empty()) {
    return 1;
  }
  ByteReader reader(path);
  return 1.0 * ReadDepthMapHeader(&reader).width / view.width;
}

}  // namespace

Views ReadViews(const std::filesystem::path& dense_path,
                const SparseModel& model, bool allow_distortion) {
  Views result;
  for (const SparseImage& image : model.images) {
    const SparseCamera& camera = model.cameras.at(image.camera_id);
    if (!camera.is_pinhole && !allow_distortion) {
      throw FileError(dense_path, "camera " + std::to_string(image.camera_id) +
                                      " is distorted (" + camera.model_name +
                                      "), which no dense workspace's is; run "
                                      "`colmap image_undistorter` first");
    }
    View view = MakeView(image, camera);
    const std::filesystem::path path = dense_path / "images" / image.name;
    if (const std::optional<ImageSize> size = ReadImageSize(path)) {
      result.num_rescaled_images += ScaleToPicture(*size, path, &view);
    } else {
      ++result.num_missing_images;
    }
    result.depth_map_scales.push_back(ReadDepthMapScale(dense_path, view));
    result.views.push_back(std::move(view));
  }
  return result;
}

}  // namespace colmap_ext
