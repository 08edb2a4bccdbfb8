#include "workspace/read_views.h"

#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/picture_size.h"
#include "formats/read_depth_map.h"

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

bool HasAspectOf(const View& view, const PictureSize& size) {
  const double scale_x = 1.0 * size.width / view.width;
  const double scale_y = 1.0 * size.height / view.height;
  return std::abs(view.height * scale_x - size.height) <= 1 ||
         std::abs(view.width * scale_y - size.width) <= 1;
}

// From the header of a PNG or JPEG file, else by decoding the whole picture.
std::optional<PictureSize> FindPictureSize(const std::filesystem::path& path,
                                           const PictureDecoder& decoder) {
  std::optional<PictureSize> size = ReadPictureSize(path);
  if (!size) {
    if (const std::optional<ColorImage> image = decoder.read_color(path)) {
      size = PictureSize{image->width, image->height};
    }
  }
  if (size && (size->width <= 0 || size->height <= 0)) {
    size.reset();
  }
  return size;
}

// Scales the view to its picture.
// \return what is wrong with the picture
std::string FitToPicture(const std::filesystem::path& path,
                         const ViewRules& rules, const PictureDecoder& decoder,
                         View* view, Views* result) {
  const std::optional<PictureSize> size = FindPictureSize(path, decoder);
  if (!size) {
    ++result->num_missing_images;
    return std::filesystem::exists(path) ? "can not be read" : "no such file";
  }
  if (size->width == view->width && size->height == view->height) {
    return "";
  }
  if (!HasAspectOf(*view, *size)) {
    const std::string error =
        fmt::format("is {} x {} pixels, but its camera is {} x {}", size->width,
                    size->height, view->width, view->height);
    if (!rules.allow_other_sizes) {
      throw FileError(path, error +
                                ", which is not the same picture scaled; run "
                                "`colmap image_undistorter` again");
    }
    return error;
  }
  *view = ResizeView(*view, size->width, size->height);
  ++result->num_rescaled_images;
  return "";
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
                const SparseModel& model, const ViewRules& rules,
                const PictureDecoder& decoder) {
  Views result;
  for (const SparseImage& image : model.images) {
    const SparseCamera& camera = model.cameras.at(image.camera_id);
    if (!camera.is_pinhole && !rules.allow_distortion) {
      throw FileError(
          dense_path,
          fmt::format("camera {} is distorted ({}), which no dense workspace's "
                      "is; run `colmap image_undistorter` first",
                      image.camera_id, camera.model_name));
    }
    if (!camera.has_focal_length) {
      throw FileError(
          dense_path,
          fmt::format("camera {} is a panorama ({}), which can not be meshed; "
                      "cut it into pinhole images first",
                      image.camera_id, camera.model_name));
    }
    View view = MakeView(image, camera);
    result.picture_errors.push_back(FitToPicture(
        dense_path / "images" / image.name, rules, decoder, &view, &result));
    result.camera_scales.push_back(1.0 * static_cast<double>(camera.width) /
                                   view.width);
    result.depth_map_scales.push_back(ReadDepthMapScale(dense_path, view));
    result.views.push_back(std::move(view));
  }
  return result;
}

}  // namespace colmap_ext
