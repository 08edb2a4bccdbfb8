#include "colmap_ext/jobs/refinement_input.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/jobs/refinement_estimate.h"
#include "colmap_ext/terminal/terminal.h"
#include "formats/read_numbers.h"
#include "formats/write_mesh.h"
#include "mesh/clip_mesh.h"
#include "mesh/normals.h"
#include "mesh/topology.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// A pixel takes one byte in an image, and mostly three where facets are drawn.
constexpr double kImageShare = 0.25;
constexpr double kDrawingShare = 0.75;

// The least share of the memory that is left for drawings: some views and their
// partners. Chosen by hand.
constexpr double kMinDrawingShare = 0.25;

constexpr const char* kFusedName = "fused.ply";
constexpr const char* kRefinerOutput = "meshed-refined.ply";
constexpr const char* kRefinedSparseName = "sparse-refined";

constexpr VisibilityOwner kMesh = {
    "mesh",
    "make the mesh again, or remove its .vis, and the images that see it come "
    "from the nearest fused points",
    std::nullopt};

fs::path FindWorkspaceFolder(const RefinerOptions& options) {
  const fs::path path = options.workspace_path;
  std::vector<std::string> files = {kMesherOutput, kFusedName};
  if (!options.fused_path.empty()) {
    files.push_back("stereo");  // a folder
  }
  const fs::path found = FindFolderWith(files, path);
  if (found.empty() && options.input_path.empty() &&
      options.fused_path.empty()) {
    throw FileError(path,
                    fmt::format("no {} here nor in dense/ or dense/0/; run "
                                "`{} delaunay_manifold_mesher "
                                "--workspace_path DIR` first",
                                kMesherOutput, ProgramName()));
  }
  return found.empty() ? path : found;
}

// Sorts each row, and drops what it has twice.
void SortViews(VertexAttributes* attributes) {
  EditRows(
      [](size_t, std::span<uint32_t> row) {
        std::ranges::sort(row);
        return static_cast<size_t>(std::unique(row.begin(), row.end()) -
                                   row.begin());
      },
      &attributes->views);
}

// Makes the mesh manifold if it is not.
// \return what was done, without the arrays
std::optional<ManifoldRepair> Repair(const fs::path& path, Surface* file) {
  if (Analyze(file->mesh).IsManifold()) {
    return std::nullopt;
  }
  ManifoldRepair repair = RepairManifold(file->mesh);
  if (repair.mesh.facets.empty()) {
    throw FileError(path, "none of its faces can be used");
  }
  file->Become(std::exchange<DerivedMesh>(repair, {}));
  return repair;
}

// Cuts off what lies outside of the region, but for a margin: the border of
// what is refined moves a little.
void CutOff(const Region& region, const fs::path& path, Surface* file) {
  constexpr double kMargin = 0.01;  // of the region's diagonal
  CutOff(Grow(region, kMargin * 2 * region.half_sizes.norm()), file);
  if (file->mesh.facets.empty()) {
    throw FileError(path, "none of its faces lies in the region");
  }
}

// The vertices with their normals, as fused points are read.
PlyCloud VertexCloud(const Surface& file) {
  const TriangleMesh& mesh = file.mesh;
  PlyCloud cloud{mesh.vertices,
                 std::vector<Eigen::Vector3f>(mesh.vertices.size(),
                                              Eigen::Vector3f::Zero()),
                 file.attributes.colors};
  for (const Facet& facet : mesh.facets) {
    const Eigen::Vector3f normal = AreaVector(mesh, facet);
    for (const uint32_t vertex : facet) {
      cloud.normals[vertex] += normal;
    }
  }
  return cloud;
}

Workspace ReadCameras(const RefinerOptions& options,
                      const RefinementPaths& paths,
                      const PictureDecoder& decoder,
                      const RefinementInput& input) {
  const WorkspaceOptions rules = {.fused_path = options.fused_path,
                                  .image_order = options.image_order,
                                  .sparse_path = options.sparse_path,
                                  .allow_other_sizes = true};
  if (input.has_fused_points) {
    return ReadWorkspace(paths.folder, rules, decoder);
  }
  if (!input.has_visibility) {
    throw FileError(paths.fused,
                    "no such file, and " + VisibilityPath(paths.mesh).string() +
                        " neither, so that it is not known which images see "
                        "the mesh; run `colmap stereo_fusion` first");
  }
  return ReadMeshWorkspace(paths.folder, rules, decoder,
                           {{VertexCloud(input), input.attributes.views},
                            {paths.mesh, VisibilityPath(paths.mesh)}});
}

// Views and colours that the mesh's files do not have.
void CompleteAttributes(RefinementInput* input) {
  const bool has_colors = !input->attributes.colors.empty();
  input->colors_from = has_colors ? "the mesh" : "nowhere";
  if (!input->has_fused_points || (has_colors && input->has_visibility)) {
    return;
  }
  VertexAttributes nearest = NearestAttributes(input->mesh, input->points);
  if (!input->has_visibility) {
    input->attributes.views = std::move(nearest.views);
  }
  if (!has_colors && !nearest.colors.empty()) {
    input->attributes.colors = std::move(nearest.colors);
    input->colors_from = "the nearest fused points";
  }
}

}  // namespace

Surface ReadSurface(const fs::path& path, bool has_visibility,
                    const VisibilityOwner& owner) {
  ColoredMesh read = ReadColoredPlyMesh(path);
  if (read.mesh.facets.empty()) {
    throw FileError(path, "it has no faces: not a mesh");
  }
  const auto num_flat =
      std::ranges::count_if(read.mesh.facets, [&](const Facet& facet) {
        return AreaVector(read.mesh, facet) == Eigen::Vector3f::Zero();
      });
  if (2 * static_cast<size_t>(num_flat) > read.mesh.facets.size()) {
    throw FileError(path,
                    "most of its faces have no area; if it lies far from the "
                    "origin, its coordinates are too large for 32-bit floats: "
                    "move it nearer");
  }
  const size_t num_vertices = read.mesh.vertices.size();
  return {std::move(read.mesh),
          {std::move(read.colors),
           has_visibility
               ? ReadVisibility(VisibilityPath(path), num_vertices, owner)
               : Rows<uint32_t>(num_vertices),
           std::move(read.confidences)}};
}

void ExpectViews(const Surface& surface, size_t num_views, const fs::path& path,
                 const std::string& model, const VisibilityOwner& owner) {
  const std::vector<uint32_t>& views = surface.attributes.views.values;
  const auto highest = std::ranges::max_element(views);
  if (highest != views.end() && *highest >= num_views) {
    throw FileError(
        VisibilityPath(path),
        fmt::format("lists image {}, but the {} has {}: it belongs "
                    "to another {}; {}",
                    *highest, model, num_views, model, owner.what_to_do));
  }
}

RefinementPaths FindRefinementPaths(const RefinerOptions& options) {
  const fs::path folder = FindWorkspaceFolder(options);
  const auto given_or = [&](const std::string& given, const char* name) {
    return given.empty() ? folder / name : fs::path(given);
  };
  const RefinementPaths paths{folder,
                              given_or(options.input_path, kMesherOutput),
                              given_or(options.fused_path, kFusedName),
                              given_or(options.output_path, kRefinerOutput),
                              folder / kRefinedSparseName};
  if (!fs::exists(paths.mesh)) {
    throw FileError(paths.mesh,
                    options.input_path.empty()
                        ? fmt::format("no such file; run `{} "
                                      "delaunay_manifold_mesher` first, or "
                                      "name a mesh by --input_path",
                                      ProgramName())
                        : "no such file");
  }
  if (!options.fused_path.empty() && !fs::exists(paths.fused)) {
    throw FileError(paths.fused, "no such file");
  }
  std::error_code ignored;
  RefuseIf(fs::equivalent(paths.mesh, paths.output, ignored),
           "--output_path is the mesh that is to be refined");
  RefuseIf(
      options.refinement.cameras.parts != RefinedParts::kNothing &&
          !options.sparse_path.empty() &&
          fs::equivalent(options.sparse_path, paths.refined_sparse, ignored),
      "--sparse_path is where the refined cameras are written to; move it "
      "away first, or take --FacetwiseRefinement.refine_cameras none");
  return paths;
}

size_t RefinementInput::MaxDrawingMemory() const {
  return static_cast<size_t>(kDrawingShare * 1e9 * expected.cache_gb);
}

void ReadPictures(const RefinerOptions& options, const Surface& surface,
                  const fs::path& images_path, const ReadGrayImage& read_mask,
                  const PictureDecoder& decoder, RefinementInput* input) {
  const std::vector<View> views = input->views;
  for (View& view : input->views) {
    view = ViewAtScale(view, options.image_scale);
  }
  const ReadGrayImage masks = ResizedMasks(read_mask, input->views);
  if (masks) {
    input->masks = MaskCloud(masks, input->views, &input->points);
  }
  input->expected = EstimateRun(surface, input->views, options);
  const double cache = 1e9 * input->expected.cache_gb;
  input->images = std::make_shared<ImagePyramid>(
      input->views,
      ResizedImages(PictureReader(images_path, views, decoder), views,
                    input->views),
      static_cast<size_t>(kImageShare * cache), masks,
      static_cast<size_t>((kDrawingShare - kMinDrawingShare) * cache));
  FindUnreadable([input](size_t view) { input->images->Image(view); },
                 &input->picture_errors);
  if (!options.skip_missing_images) {
    ExpectPictures(images_path, input->views, input->picture_errors);
  }
  RemoveUnusable(images_path, input->picture_errors, &input->points);
}

RefinementInput ReadRefinementInput(const RefinerOptions& options,
                                    const RefinementPaths& paths,
                                    const PictureDecoder& decoder,
                                    const Progress& progress) {
  RefinementInput input;
  input.has_visibility = fs::exists(VisibilityPath(paths.mesh));
  input.has_fused_points = paths.HasFusedPoints();
  Report(progress, "Reading the mesh", 0);
  Surface& surface = input;
  surface = ReadSurface(paths.mesh, input.has_visibility, kMesh);
  SortViews(&input.attributes);
  input.repair = Repair(paths.mesh, &input);
  Report(progress, "Reading the workspace", 0);
  Workspace workspace = ReadCameras(options, paths, decoder, input);
  ExpectViews(input, workspace.views.size(), paths.mesh, "sparse model", kMesh);
  input.region =
      options.scene.region.Resolve(workspace.views, workspace.sparse_points);
  if (input.region) {
    CutOff(*input.region, paths.mesh, &input);
  }
  input.views = std::move(workspace.views);
  input.points = std::move(workspace.cloud);
  input.picture_errors = std::move(workspace.picture_errors);
  input.workspace = std::move(workspace.report);
  CompleteAttributes(&input);
  Report(progress, "Reading the images", 0);
  const std::string& masks = options.scene.mask_path;
  ReadPictures(
      options, input, paths.folder / "images",
      masks.empty() ? ReadGrayImage() : MaskReader(masks, input.views, decoder),
      decoder, &input);
  Report(progress, "Reading the sparse model", 0);
  input.cameras = ReadRefinableCameras(input.workspace.sparse_path, input.views,
                                       input.images);
  return input;
}

JobInputs RunInputs(const RefinerOptions& options, const RefinementPaths& paths,
                    const RefinementInput& input) {
  JobInputs inputs;
  inputs.AddOptions(&AddResultOptions, options);
  inputs.options["image_order"] = NameOf(input.workspace.order.order.kind);
  inputs.options["region"] = input.region ? RegionText(*input.region) : "";
  std::vector<std::pair<std::string, fs::path>> files = {
      {"--input_path", paths.mesh},
      {"--input_path.vis", VisibilityPath(paths.mesh)},
      {"fused.ply", paths.fused},
      {"fused.ply.vis", VisibilityPath(paths.fused)}};
  for (const fs::path& path : SparseModelFiles(input.workspace.sparse_path)) {
    files.emplace_back("sparse/" + path.filename().string(), path);
  }
  for (const View& view : input.views) {
    files.emplace_back("images/" + view.name,
                       paths.folder / "images" / view.name);
    if (input.masks) {
      files.emplace_back("masks/" + view.name,
                         FindMask(options.scene.mask_path, view.name));
    }
  }
  inputs.AddFiles(files);
  return inputs;
}

}  // namespace colmap_ext
