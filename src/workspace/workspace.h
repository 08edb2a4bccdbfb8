#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/read_ply.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "workspace/image_order.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

struct FilterReport {
  size_t num_points = 0;         // that came in
  size_t num_not_finite = 0;     // dropped, see IsMeasurable()
  size_t num_without_views = 0;  // dropped
  size_t num_with_repeats = 0;   // that listed an image more than once
  size_t num_out_of_range = 0;   // that listed an image which is not there
};

// Shortens the views of points, or drops the points.
// \param edit  of a point and its views, as EditRows() has it
template <typename Edit>
void EditPoints(const Edit& edit, PointCloud* cloud) {
  size_t num_kept = 0;
  EditRows(
      [&](size_t point, std::span<uint32_t> views) {
        const std::optional<size_t> num_views = edit(point, views);
        if (num_views) {
          cloud->positions[num_kept] = cloud->positions[point];
          if (!cloud->colors.empty()) {
            cloud->colors[num_kept] = cloud->colors[point];
          }
          ++num_kept;
        }
        return num_views;
      },
      &cloud->views);
  cloud->positions.resize(num_kept);
  cloud->colors.resize(cloud->colors.empty() ? 0 : num_kept);
}

// The points that can be meshed: finite, and seen by some image. Image indices
// that are out of range or repeated are dropped, the rest sorted.
PointCloud FilterCloud(PlyCloud cloud, Visibility visibility, size_t num_images,
                       FilterReport* report);

struct Views {
  std::vector<View> views;  // as the model's images
  // [views] size of each camera over the size of its picture; 1 where there is
  // no picture.
  std::vector<double> camera_scales;
  // [views] size of each depth map over the size of its picture; 1 where there
  // is no depth map.
  std::vector<double> depth_map_scales;
  // [views] why the picture cannot be used: it is missing, cannot be read,
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

enum class InputType {
  kDense,   // the fused points
  kSparse,  // those of the sparse model
};

struct WorkspaceOptions {
  InputType input_type = InputType::kDense;

  // The fused points, with their .vis beside them; empty: fused.ply in the
  // workspace.
  std::filesystem::path fused_path = {};

  // Where there are more fused points, a sample of them is read, every so many,
  // without ever holding more; 2 or more. Views, sparse points and the order of
  // the images are those of all.
  size_t max_points = SIZE_MAX;

  // How fused.ply.vis counts the images; nothing: it is found out.
  std::optional<ImageOrderKind> image_order = std::nullopt;

  // The sparse model, or a folder that has one; empty: that of the workspace.
  std::filesystem::path sparse_path = {};

  // Accept pictures of another aspect than their camera's. They are listed in
  // Workspace::picture_errors.
  bool allow_other_sizes = false;
};

struct WorkspaceReport {
  std::filesystem::path path;         // the folder that was used
  std::filesystem::path sparse_path;  // of the model
  FilterReport points;
  size_t num_sparse_points = 0;
  size_t num_missing_images = 0;
  size_t num_rescaled_images = 0;
  bool is_order_verified = false;  // of the images; not asked for sparse input
  VerifiedOrder order;
};

// A COLMAP workspace in our types. Its views are in the order of the image
// indices of fused.ply.vis.
struct Workspace : Views {
  PointCloud cloud;                            // view indices < views.size()
  std::vector<Eigen::Vector3f> sparse_points;  // finite
  WorkspaceReport report;
};

// The folder of the workspace that dense input is read from.
// \throw FileError if there is none, or several.
std::filesystem::path FindDenseFolder(const std::filesystem::path& path,
                                      const WorkspaceOptions& options);

// Reads DIR/sparse and, for dense input, DIR/fused.ply and DIR/fused.ply.vis,
// or the points that the options name.
//
// \throw FileError for whatever is missing, damaged, or does not fit together.
Workspace ReadWorkspace(const std::filesystem::path& path,
                        const WorkspaceOptions& options,
                        const PictureDecoder& decoder);

// The files of the fused points of a workspace.
struct FusedFiles {
  std::filesystem::path path;
  std::filesystem::path visibility_path;
};

// \throw FileError as FindDenseFolder()
FusedFiles FindFusedFiles(const std::filesystem::path& path,
                          const WorkspaceOptions& options);

// A cloud, which images see each point, and the files that both are of.
struct SeenCloud : CloudPiece, FusedFiles {};

// The same with the vertices of a mesh in place of the fused points.
// \param folder  the workspace itself.
Workspace ReadMeshWorkspace(const std::filesystem::path& folder,
                            const WorkspaceOptions& options,
                            const PictureDecoder& decoder, SeenCloud vertices);

}  // namespace colmap_ext
