#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "workspace/filter_cloud.h"
#include "workspace/image_order.h"
#include "workspace/read_views.h"

namespace colmap_ext {

enum class InputType {
  kDense,   // the fused points
  kSparse,  // those of the sparse model
};

struct WorkspaceOptions {
  InputType input_type = InputType::kDense;

  // The fused points, with their .vis beside them; empty: fused.ply in the
  // workspace.
  std::filesystem::path fused_path = {};

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

// The same of a sample of the fused points, every so many, without ever holding
// more: views, sparse points and the order of the images are those of all.
// \param max_points  2 or more; where there are no more all are there
Workspace ReadSampledWorkspace(const std::filesystem::path& path,
                               const WorkspaceOptions& options,
                               const PictureDecoder& decoder,
                               size_t max_points);

// A cloud, which images see each point, and the files that both are of.
struct SeenCloud : CloudPiece, FusedFiles {};

// The same with the vertices of a mesh in place of the fused points.
// \param folder  the workspace itself.
Workspace ReadMeshWorkspace(const std::filesystem::path& folder,
                            const WorkspaceOptions& options,
                            const PictureDecoder& decoder, SeenCloud vertices);

}  // namespace colmap_ext
