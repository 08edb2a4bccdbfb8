#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/options/viewer_options.h"
#include "scene/color_image.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/region.h"
#include "scene/view.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The files that a mesh of the viewer is read from.
struct ShownMeshPaths {
  std::filesystem::path mesh;
  std::filesystem::path labels;  // see ViewerOptions; may be empty
  std::filesystem::path errors;
  std::optional<Region> region;  // the part that is shown; nullopt: all
};

// Reads a mesh or cloud, and its .vis if there is one. Skips facets with a
// vertex that is not finite. Uses labels and errors of a mesh with the same
// number of facets or vertices. \param notes  gets a line for each file that
// does not fit the mesh. \throw FileError if a file cannot be read.
ShownMesh ReadShownMesh(const ShownMeshPaths& paths,
                        std::vector<std::string>* notes);

// Paths of the viewer's input.
struct ViewerPaths {
  std::filesystem::path folder;  // the dense workspace; empty: none
  std::vector<ShownMeshPaths> meshes;
};

// \throw FileError if there are several workspaces, or no mesh.
ViewerPaths FindViewerPaths(const ViewerOptions& options);

// The contents of a workspace besides meshes.
struct ViewerWorkspace {
  std::vector<View> views;                   // may be empty
  std::shared_ptr<const PointCloud> points;  // fused, or else sparse; or none
  bool has_order = false;          // the views are in the order of .vis files
  std::vector<std::string> notes;  // unusable files, and why
};

// Reads the fused points and the cameras in their order; if that fails, the
// sparse model; if that fails too, nothing.
ViewerWorkspace ReadViewerWorkspace(const ViewerOptions& options,
                                    const ViewerPaths& paths,
                                    const PictureDecoder& decoder);

// An image of at most `max_size` px a side; nullptr if it cannot be read.
std::shared_ptr<const ColorImage> ReadShownImage(
    const std::filesystem::path& folder, const View& view, int max_size,
    const PictureDecoder& decoder);

inline constexpr int kThumbnailSize = 192;  // px a side; chosen by hand
inline constexpr int kImageSize = 2048;     // px a side of images over meshes

}  // namespace colmap_ext
