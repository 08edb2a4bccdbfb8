#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/jobs/mesh_tiles.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/report/html_page.h"
#include "colmap_ext/run_command.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/write_mesh.h"
#include "mesh/mesh_in_image.h"
#include "meshing/manifold_meshing.h"
#include "photometry/image_pyramid.h"
#include "scene/half_pixel.h"
#include "workspace/read_pictures.h"
#include "workspace/workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

// Moves the points.
HalfPixelReport CorrectHalfPixel(const MesherOptions& options,
                                 Workspace* workspace) {
  const std::vector<Eigen::Vector3f> offsets = HalfPixelOffsets(
      workspace->cloud, workspace->views, workspace->depth_map_scales);
  HalfPixelReport report;
  report.slope =
      RegressHalfPixel(workspace->cloud, offsets, workspace->sparse_points);
  if (options.half_pixel == HalfPixelCorrection::kAuto) {
    report.scale = CalibratedScale(report.slope);
  }
  for (size_t i = 0; i < offsets.size(); ++i) {
    workspace->cloud.positions[i] +=
        static_cast<float>(report.scale) * offsets[i];
  }
  return report;
}

// Called before the points are read, so that an unwritable output fails early.
std::filesystem::path FindOutputPath(const MesherOptions& options) {
  std::filesystem::path folder = options.InputPath();
  if (options.workspace.input_type == InputType::kDense) {
    folder = FindDenseFolder(folder, options.workspace);
  }
  const std::filesystem::path output =
      options.output_path.empty() ? folder / kMesherOutput
                                  : std::filesystem::path(options.output_path);
  ExpectOutputs(
      {output, VisibilityPath(output), options.report_path,
       options.scene.region.FoundPath(output)},
      WorkspaceInputs(folder, options.workspace.fused_path,
                      options.workspace.sparse_path,
                      {options.scene.mask_path, options.scene.transform_path,
                       options.scene.region.text}));
  return output;
}

// The views at the sizes of their cameras, if those are requested and differ.
std::vector<View> MeshingViews(const MesherOptions& options,
                               const Workspace& workspace) {
  std::vector<View> views = workspace.views;
  for (size_t i = 0; options.has_camera_pixels && i < views.size(); ++i) {
    views[i] = ViewAtScale(views[i], workspace.camera_scales[i]);
  }
  return views;
}

// Says where the pixels of max_proj_dist are other ones than our own option's.
void PrintPixels(const MesherOptions& options, const Workspace& workspace,
                 ReportLog* log) {
  const auto it = std::ranges::find_if(workspace.camera_scales,
                                       [](double scale) { return scale != 1; });
  if (options.has_camera_pixels && it != workspace.camera_scales.end()) {
    const double distance = options.meshing.thinning.max_proj_dist;
    PrintText(
        "max_proj_dist",
        fmt::format("{} px of the cameras, as COLMAP has it: {:.4g} px "
                    "of images such as {}",
                    distance, distance / *it,
                    workspace.views[it - workspace.camera_scales.begin()].name),
        log);
  }
}

// The ends of rays to the depth maps, each with its view.
PointCloud ReadDepthEnds(const Workspace& workspace) {
  const std::vector<View>& views = workspace.views;
  const auto read_depths =
      DepthMapReader(workspace.report.path / "stereo" / "depth_maps", views);
  std::vector<std::vector<Eigen::Vector3f>> ends(views.size());
  tbb::parallel_for(size_t{0}, views.size(), [&](size_t i) {
    ends[i] = DepthRayEnds(views[i], read_depths(i));
  });
  PointCloud all;
  for (uint32_t i = 0; i < ends.size(); ++i) {
    for (const Eigen::Vector3f& end : ends[i]) {
      all.positions.push_back(end);
      all.views.AddRow(std::array{i});
    }
  }
  return all;
}

// What the masks say.
struct Masked {
  std::optional<MaskReport> report;  // nothing without masks
  RayEnds ends;                      // of rays through the background
};

// Drops the workspace's points and the ends of rays that are masked.
Masked MaskWorkspace(const MesherOptions& options,
                     const std::optional<Region>& region,
                     const Progress& progress, Workspace* workspace,
                     PointCloud* depth_ends) {
  if (options.scene.mask_path.empty()) {
    return {};
  }
  Report(progress, "Masking points", 0);
  const std::vector<View>& views = workspace->views;
  const ReadGrayImage read_mask =
      MaskReader(options.scene.mask_path, views, ColmapPictureDecoder());
  Masked masked;
  masked.report = MaskCloud(read_mask, views, &workspace->cloud);
  MaskCloud(read_mask, views, depth_ends);
  if (workspace->cloud.size() == 0) {
    throw FileError(options.scene.mask_path, "all points are masked");
  }
  if (options.mask_background) {
    const Region bounds = region ? Grow(*region, MarginOf(*region))
                                 : RegionOfCloud(workspace->cloud);
    for (uint32_t i = 0; i < views.size(); ++i) {
      Append(BackgroundEnds(bounds, views[i], i, read_mask(i)), &masked.ends);
    }
  }
  return masked;
}

// What is meshed.
struct MesherInput {
  Workspace workspace;
  std::optional<HalfPixelReport> half_pixel;
  ManifoldMeshingOptions meshing;
  Masked masked;
  PointCloud depth_ends;  // see ReadDepthEnds()
};

MesherInput ReadInput(const MesherOptions& options, const Progress& progress) {
  Report(progress, "Reading the workspace", 0);
  MesherInput input;
  input.workspace = ReadWorkspace(options.InputPath(), options.workspace,
                                  ColmapPictureDecoder());
  input.meshing = options.meshing;
  // Sparse points come from features, which do not have the error.
  if (options.half_pixel != HalfPixelCorrection::kOff &&
      options.workspace.input_type == InputType::kDense) {
    Report(progress, "Correcting the half pixel", 0);
    input.half_pixel = CorrectHalfPixel(options, &input.workspace);
  }
  input.meshing.region = options.scene.region.Resolve(
      input.workspace.views, input.workspace.sparse_points);
  if (options.carve_with_depth_maps) {
    Report(progress, "Reading depth maps", 0);
    input.depth_ends = ReadDepthEnds(input.workspace);
  }
  input.masked = MaskWorkspace(options, input.meshing.region, progress,
                               &input.workspace, &input.depth_ends);
  return input;
}

void PrintInput(const MesherOptions& options, const MesherInput& input,
                ReportLog* log) {
  PrintReport(input.workspace.report, input.workspace.views.size(),
              input.half_pixel, log);
  PrintPixels(options, input.workspace, log);
  PrintReport(input.masked.report, log);
  PrintReport(input.meshing.region, log);
  std::cout << std::endl;
}

void MeshWorkspace(const MesherOptions& options, Console* console) {
  const std::filesystem::path output_path = FindOutputPath(options);
  const bool has_page = !options.report_path.empty();
  const Progress& progress = console->progress;
  ReportLog* const log = &console->log;
  MesherInput input = ReadInput(options, progress);
  console->reporter.Finish();
  PrintInput(options, input, log);
  const std::vector<View> views = MeshingViews(options, input.workspace);
  const PointCloud shown = has_page ? input.workspace.cloud : PointCloud();
  const ManifoldMesh mesh =
      MeshManifold(input.meshing, std::move(input.workspace.cloud), views,
                   progress, input.masked.ends, std::move(input.depth_ends));
  Report(progress, "Writing the mesh", 0);
  AtomicFiles files;
  WriteMesh(output_path, mesh.mesh, mesh.attributes, options.scene.transform,
            &files);
  options.scene.region.WriteFound(input.meshing.region, output_path, &files);
  PagePictures pictures;
  if (has_page) {
    Report(progress, "Drawing the report", 0);
    pictures = DrawMeshing(input.workspace.views, shown, mesh,
                           input.workspace.report.path / "images",
                           ColmapPictureDecoder());
  }
  console->reporter.Finish();
  PrintReport(mesh.report, log);
  PrintFootprint(
      MedianFootprint(mesh.mesh, mesh.attributes.views, input.workspace.views),
      log);
  console->PrintTime();
  if (has_page) {
    WriteText(options.report_path,
              MeshingPage({"delaunay_manifold_mesher", output_path.string(),
                           Versions()},
                          *log, pictures),
              &files);
  }
  files.Commit();
  std::cout << "\nWrote " << output_path.string() << " and "
            << VisibilityPath(output_path).string() << std::endl;
}

void Mesh(const MesherOptions& options, Console* console) {
  if (options.plan_path.empty()) {
    MeshWorkspace(options, console);
  } else {
    MeshTile(options.plan_path, static_cast<uint32_t>(options.tile), console);
  }
}

}  // namespace

int RunDelaunayManifoldMesher(int argc, char** argv) {
  return RunCommand(
      argc, argv, &AddMesherOptions, &Mesh,
      {"a larger --DelaunayManifoldMeshing.max_proj_dist keeps fewer points",
       "fused.ply, fused.ply.vis and sparse/",
       {{Alternative::kUseSparsePoints,
         ", or mesh the sparse points with --input_type sparse"}}});
}

}  // namespace colmap_ext
