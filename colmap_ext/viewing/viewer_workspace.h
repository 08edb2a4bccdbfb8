#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap_ext/options/viewer_options.h"
#include "colmap_ext/viewing/read_shown_mesh.h"
#include "scene/color_image.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Paths of the viewer's input.
struct ViewerPaths {
  std::filesystem::path folder;  // the dense workspace; empty: none
  std::vector<ShownMeshPaths> meshes;
};

// \throw FileError if there are several workspaces, or no mesh.
ViewerPaths FindViewerPaths(const ViewerOptions& options);

// What there is of a workspace besides meshes.
struct ViewerWorkspace {
  std::vector<View> views;                   // empty: there are no cameras
  std::shared_ptr<const PointCloud> points;  // fused, or else sparse; or none
  bool has_order = false;          // the views are those that .vis files count
  std::vector<std::string> notes;  // what can not be used, and why
};

// Reads what can be read: the fused points and the cameras in their order, or
// else the sparse model, or else nothing.
ViewerWorkspace ReadViewerWorkspace(const ViewerOptions& options,
                                    const ViewerPaths& paths,
                                    const PictureDecoder& decoder);

// An image of at most `max_size` px a side; nothing if it can not be read.
std::shared_ptr<const ColorImage> ReadShownImage(
    const std::filesystem::path& folder, const View& view, int max_size,
    const PictureDecoder& decoder);

inline constexpr int kThumbnailSize = 192;  // px a side; a choice
inline constexpr int kImageSize = 2048;     // px a side of images over meshes

}  // namespace colmap_ext
