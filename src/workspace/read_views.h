#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/picture_decoder.h"
#include "scene/view.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

struct Views {
  std::vector<View> views;  // as the model's images
  // [views] size of each camera over the size of its picture; 1 where there is
  // no picture.
  std::vector<double> camera_scales;
  // [views] size of each depth map over the size of its picture; 1 where there
  // is no depth map.
  std::vector<double> depth_map_scales;
  // [views] why the picture can not be used: it is missing, can not be read,
  // or has not its camera's aspect, and the view has its camera's size then;
  // empty where nothing is wrong.
  std::vector<std::string> picture_errors;
  size_t num_missing_images = 0;   // their camera's size was taken instead
  size_t num_rescaled_images = 0;  // of another size than their camera's
};

struct ViewRules {
  // Use the pinhole part of distorted cameras.
  bool allow_distortion = false;
  // List pictures of another aspect than their camera's in picture_errors.
  bool allow_other_sizes = false;
};

// The cameras and poses of the model's images, with the intrinsics scaled to
// the pictures in DENSE_PATH/images: COLMAP's image_undistorter scales the
// pictures of a pinhole camera and leaves the camera as it was.
//
// \throw FileError if a camera is distorted, or the aspect of a picture is not
//        its camera's, unless the rules allow that, or a camera is a panorama.
Views ReadViews(const std::filesystem::path& dense_path,
                const SparseModel& model, const ViewRules& rules,
                const PictureDecoder& decoder);

}  // namespace colmap_ext
