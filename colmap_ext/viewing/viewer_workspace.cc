#include "colmap_ext/viewing/viewer_workspace.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "formats/errors.h"
#include "pictures/drawings.h"
#include "workspace/find_workspace.h"
#include "workspace/workspace.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

// In the order in which they are shown: the best first.
constexpr const char* kMeshNames[] = {"meshed-refined.ply", kMesherOutput,
                                      "meshed-delaunay.ply",
                                      "meshed-poisson.ply"};

fs::path FindFolder(const std::string& path) {
  const std::vector<fs::path> found =
      FindFoldersWith({"fused.ply", "stereo", kMesherOutput}, path);
  ExpectOneFolder(found, path);
  return found.empty() ? fs::path(path) : found[0];
}

WorkspaceOptions RulesOf(const ViewerOptions& options, InputType type) {
  WorkspaceOptions rules;
  rules.input_type = type;
  rules.image_order = options.image_order;
  rules.sparse_path = options.sparse_path;
  rules.allow_other_sizes = true;
  return rules;
}

// \return whether it could be read
bool Read(const ViewerOptions& options, InputType type, const fs::path& folder,
          const PictureDecoder& decoder, ViewerWorkspace* result) {
  try {
    Workspace workspace =
        ReadWorkspace(folder, RulesOf(options, type), decoder);
    result->views = std::move(workspace.views);
    result->points =
        std::make_shared<const PointCloud>(std::move(workspace.cloud));
    return true;
  } catch (const FileError& error) {
    result->notes.push_back(error.what());
    return false;
  }
}

}  // namespace

ViewerPaths FindViewerPaths(const ViewerOptions& options) {
  ViewerPaths paths;
  if (!options.workspace_path.empty()) {
    paths.folder = FindFolder(options.workspace_path);
  }
  std::vector<fs::path> meshes(options.mesh_paths.begin(),
                               options.mesh_paths.end());
  if (meshes.empty()) {
    for (const char* name : kMeshNames) {
      if (fs::exists(paths.folder / name)) {
        meshes.push_back(paths.folder / name);
      }
    }
    if (meshes.empty() && fs::exists(paths.folder / "fused.ply")) {
      meshes.push_back(paths.folder / "fused.ply");
    }
  }
  if (meshes.empty()) {
    throw FileError(paths.folder,
                    "no meshed-*.ply here nor in dense/ or dense/0/; run "
                    "`colmap delaunay_manifold_mesher --workspace_path DIR` "
                    "first, or name a mesh by --mesh_path");
  }
  for (const fs::path& mesh : meshes) {
    if (!fs::exists(mesh)) {
      throw FileError(mesh, "no such file");
    }
    paths.meshes.push_back({mesh, options.labels_path, options.error_mesh_path,
                            options.region.region});
  }
  return paths;
}

ViewerWorkspace ReadViewerWorkspace(const ViewerOptions& options,
                                    const ViewerPaths& paths,
                                    const PictureDecoder& decoder) {
  ViewerWorkspace result;
  if (paths.folder.empty()) {
    return result;
  }
  if (fs::exists(paths.folder / "fused.ply")) {
    result.has_order =
        Read(options, InputType::kDense, paths.folder, decoder, &result);
  }
  if (result.views.empty()) {
    Read(options, InputType::kSparse, paths.folder, decoder, &result);
  }
  return result;
}

std::shared_ptr<const ColorImage> ReadShownImage(
    const fs::path& folder, const View& view, int max_size,
    const PictureDecoder& decoder) {
  std::optional<ColorImage> image =
      decoder.read_color(folder / "images" / view.name);
  if (!image) {
    return nullptr;
  }
  return std::make_shared<const ColorImage>(
      ShrinkPicture(*std::move(image), max_size));
}

}  // namespace colmap_ext
