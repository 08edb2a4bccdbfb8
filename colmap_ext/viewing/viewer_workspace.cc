#include "colmap_ext/viewing/scene_loader.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/terminal/terminal.h"
#include "formats/write_mesh.h"
#include "mesh/clip_mesh.h"
#include "pictures/pictures.h"
#include "workspace/workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// In the order in which they are shown: the best first.
constexpr const char* kMeshNames[] = {"meshed-refined.ply", kMesherOutput,
                                      "meshed-delaunay.ply",
                                      "meshed-poisson.ply"};

// What cannot be read is noted.
void Read(const ViewerOptions& options, InputType type, const fs::path& folder,
          const PictureDecoder& decoder, ShownScene* result) {
  try {
    Workspace workspace = ReadWorkspace(folder,
                                        {.input_type = type,
                                         .image_order = options.image_order,
                                         .sparse_path = options.sparse_path,
                                         .allow_other_sizes = true},
                                        decoder);
    result->views = std::move(workspace.views);
    result->points =
        std::make_shared<const PointCloud>(std::move(workspace.cloud));
  } catch (const FileError& error) {
    result->notes.push_back(error.what());
  }
}

// Moves vertices that are not finite to a finite one, and makes their facets
// degenerate. Indices do not change.
void DropInfinite(const std::filesystem::path& path, TriangleMesh* mesh) {
  const auto is_finite = [](const Eigen::Vector3f& v) { return v.allFinite(); };
  const auto first = std::ranges::find_if(mesh->vertices, is_finite);
  if (first == mesh->vertices.end()) {
    throw FileError(path, "none of its vertices is finite");
  }
  for (Facet& facet : mesh->facets) {
    if (!std::ranges::all_of(facet, [&](uint32_t vertex) {
          return is_finite(mesh->vertices[vertex]);
        })) {
      facet = {facet[0], facet[0], facet[0]};
    }
  }
  std::replace_if(mesh->vertices.begin(), mesh->vertices.end(),
                  std::not_fn(is_finite), Eigen::Vector3f(*first));
}

void AddLabels(const std::filesystem::path& path, ShownMesh* shown,
               std::vector<std::string>* notes) {
  ColoredMesh labeled = ReadColoredPlyMesh(path);
  if (labeled.labels.empty()) {
    throw FileError(path,
                    "it has no labels; facetwise_refiner --labels_path "
                    "writes them");
  }
  if (labeled.labels.size() != shown->mesh.facets.size()) {
    notes->push_back(path.string() + " is not of " + shown->name +
                     ", which has another number of faces");
    return;
  }
  shown->labels = std::move(labeled.labels);
  shown->label_names = std::move(labeled.label_names);
}

void AddErrors(const std::filesystem::path& path, ShownMesh* shown,
               std::vector<std::string>* notes) {
  ColoredMesh colored = ReadColoredPlyMesh(path);
  if (colored.colors.empty()) {
    throw FileError(path,
                    "it has no colors; mesh_evaluator "
                    "--error_mesh_path writes them");
  }
  if (colored.mesh.vertices.size() != shown->mesh.vertices.size()) {
    notes->push_back(path.string() + " is not of " + shown->name +
                     ", which has another number of vertices");
    return;
  }
  shown->error_colors = std::move(colored.colors);
}

// Of points without facets.
Provenance ClipCloud(const Region& region, TriangleMesh* cloud) {
  Provenance from;
  std::vector<Eigen::Vector3f> kept;
  for (uint32_t i = 0; i < cloud->vertices.size(); ++i) {
    if (region.Contains(cloud->vertices[i])) {
      kept.push_back(cloud->vertices[i]);
      from.vertices.push_back({i, i});
    }
  }
  cloud->vertices = std::move(kept);
  return from;
}

// Keeps the part in the region. Vertices on its border get the data of the
// inner ends of their edges.
void Crop(const Region& region, ShownMesh* shown) {
  const std::optional<Provenance> from = shown->mesh.facets.empty()
                                             ? ClipCloud(region, &shown->mesh)
                                             : ClipMesh(region, &shown->mesh);
  if (!from) {
    return;
  }
  const auto before = std::exchange<VertexAttributes>(*shown, {});
  const auto error_colors = std::exchange(shown->error_colors, {});
  for (const auto& source : from->vertices) {
    AddAttributes(before, source[0], shown);
    AppendIfAny(error_colors, source[0], &shown->error_colors);
  }
  const auto labels = std::exchange(shown->labels, {});
  for (const uint32_t source : from->facets) {
    AppendIfAny(labels, source, &shown->labels);
  }
}

}  // namespace

ViewerPaths FindViewerPaths(const ViewerOptions& options) {
  ViewerPaths paths;
  if (!options.workspace_path.empty()) {
    const fs::path found = FindFolderWith(
        {"fused.ply", "stereo", kMesherOutput}, options.workspace_path);
    paths.folder = found.empty() ? fs::path(options.workspace_path) : found;
  }
  std::vector<fs::path>& meshes = paths.meshes;
  meshes.assign(options.mesh_paths.begin(), options.mesh_paths.end());
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
                    fmt::format("no meshed-*.ply here nor in dense/ or "
                                "dense/0/; run `{} delaunay_manifold_mesher "
                                "--workspace_path DIR` first, or name a mesh "
                                "by --mesh_path",
                                ProgramName()));
  }
  for (const fs::path& mesh : meshes) {
    if (!fs::exists(mesh)) {
      throw FileError(mesh, "no such file");
    }
  }
  return paths;
}

ShownScene ReadViewerWorkspace(const ViewerOptions& options,
                               const ViewerPaths& paths,
                               const PictureDecoder& decoder) {
  ShownScene result;
  if (paths.folder.empty()) {
    return result;
  }
  if (fs::exists(paths.folder / "fused.ply")) {
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

ShownMesh ReadShownMesh(const fs::path& path, const ViewerOptions& options,
                        std::vector<std::string>* notes) {
  ColoredMesh read = ReadColoredPlyMesh(path);
  ShownMesh shown{{std::move(read.colors), {}, std::move(read.confidences)},
                  path.filename().string(),
                  std::move(read.mesh)};
  shown.labels = std::move(read.labels);
  shown.label_names = std::move(read.label_names);
  DropInfinite(path, &shown.mesh);
  for (const Eigen::Vector3f& normal : read.normals) {
    if (normal.allFinite()) {
      shown.front += normal.cast<double>();
    }
  }
  if (!options.labels_path.empty()) {
    AddLabels(options.labels_path, &shown, notes);
  }
  if (!options.error_mesh_path.empty()) {
    AddErrors(options.error_mesh_path, &shown, notes);
  }
  if (const fs::path visibility = VisibilityPath(path); exists(visibility)) {
    try {
      shown.views = ReadVisibility(visibility, shown.mesh.vertices.size());
    } catch (const FileError& error) {
      notes->push_back(error.what());
    }
  }
  if (options.region.region) {
    Crop(*options.region.region, &shown);
    if (shown.mesh.vertices.empty()) {
      throw FileError(path, "it has no part in the region");
    }
  }
  return shown;
}

size_t FindView(const std::vector<View>& views, const std::string& name) {
  const auto found = std::ranges::find(views, name, &View::name);
  if (found == views.end()) {
    throw OptionError("--image_name: the workspace has no image " + name +
                      (views.empty()
                           ? ", nor any other"
                           : "; one that it has is " + views.front().name));
  }
  return found - views.begin();
}

}  // namespace colmap_ext
