#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/options/add_meshing_options.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/write_mesh.h"
#include "meshing/manifold_meshing.h"
#include "scene/half_pixel.h"
#include "workspace/find_workspace.h"
#include "workspace/masks.h"
#include "workspace/workspace.h"

namespace colmap_ext {

namespace {

CommandAdvice Advice() {
  return {"a larger --DelaunayManifoldMeshing.max_proj_dist keeps fewer points",
          "fused.ply, fused.ply.vis and sparse/",
          {{Alternative::kSayImageOrder, "; say it with --image_order"},
           {Alternative::kOtherImageOrder, "; choose another --image_order"},
           {Alternative::kUseSparsePoints,
            ", or mesh the sparse points with --input_type sparse"}}};
}

// Moves the points.
HalfPixelReport CorrectHalfPixel(const MesherOptions& options,
                                 Workspace* workspace) {
  const std::vector<Eigen::Vector3f> offsets = HalfPixelOffsets(
      workspace->cloud, workspace->views, workspace->depth_map_scales);
  HalfPixelReport report;
  report.slope =
      RegressHalfPixel(workspace->cloud, offsets, workspace->sparse_points);
  if (options.half_pixel_calibration) {
    report.scale = CalibratedScale(report.slope);
  }
  for (size_t i = 0; i < offsets.size(); ++i) {
    workspace->cloud.positions[i] +=
        static_cast<float>(report.scale) * offsets[i];
  }
  return report;
}

// Before the points are read, so that nobody waits for a mesh that can not be
// written.
std::filesystem::path FindOutputPath(const MesherOptions& options) {
  const std::filesystem::path input_path = options.InputPath();
  const std::filesystem::path output_path =
      options.OutputPath(options.workspace.input_type == InputType::kDense
                             ? FindDenseFolder(input_path, options.workspace)
                             : input_path);
  ExpectWritable(output_path);
  ExpectWritable(VisibilityPath(output_path));
  if (options.region.is_auto) {
    ExpectWritable(RegionPath(output_path));
  }
  return output_path;
}

// The views at the sizes of their cameras, where those are asked for and
// differ.
std::vector<View> MeshingViews(const MesherOptions& options,
                               const Workspace& workspace) {
  std::vector<View> views = workspace.views;
  for (size_t i = 0; options.has_camera_pixels && i < views.size(); ++i) {
    const double scale = workspace.camera_scales[i];
    views[i] = ResizeView(
        views[i], static_cast<int>(std::lround(scale * views[i].width)),
        static_cast<int>(std::lround(scale * views[i].height)));
  }
  return views;
}

// Says where the pixels of max_proj_dist are other ones than our own option's.
void PrintPixels(const MesherOptions& options, const Workspace& workspace) {
  const auto it = std::find_if(workspace.camera_scales.begin(),
                               workspace.camera_scales.end(),
                               [](double scale) { return scale != 1; });
  if (options.has_camera_pixels && it != workspace.camera_scales.end()) {
    const double distance = options.meshing.max_proj_dist;
    PrintText(
        "max_proj_dist",
        fmt::format("{} px of the cameras, as COLMAP has it: {:.4g} px "
                    "of images such as {}",
                    distance, distance / *it,
                    workspace.views[it - workspace.camera_scales.begin()].name),
        std::cout);
  }
}

// What the masks say.
struct Masked {
  std::optional<MaskReport> report;  // nothing without masks
  RayEnds ends;                      // of rays through the background
};

// Takes masked points out of the workspace.
Masked MaskWorkspace(const MesherOptions& options,
                     const std::optional<Region>& region,
                     const Progress& progress, Workspace* workspace) {
  if (options.mask_path.empty()) {
    return {};
  }
  Report(progress, "Masking points", 0);
  const std::vector<View>& views = workspace->views;
  const ReadGrayImage read_mask =
      MaskReader(options.mask_path, views, ColmapPictureDecoder());
  Masked masked;
  masked.report = MaskCloud(read_mask, views, &workspace->cloud);
  if (workspace->cloud.size() == 0) {
    throw FileError(options.mask_path, "all points are masked");
  }
  if (options.mask_background) {
    const Region bounds = region ? Grow(*region, MarginOf(*region))
                                 : RegionOfCloud(workspace->cloud);
    for (uint32_t i = 0; i < views.size(); ++i) {
      masked.ends.Add(BackgroundEnds(bounds, views[i], i, read_mask(i)));
    }
  }
  return masked;
}

// Reads the workspace and puts its points right.
Workspace ReadPoints(const MesherOptions& options, const Progress& progress,
                     std::optional<HalfPixelReport>* half_pixel) {
  Report(progress, "Reading the workspace", 0);
  Workspace workspace = ReadWorkspace(options.InputPath(), options.workspace,
                                      ColmapPictureDecoder());
  // Sparse points come from features, which do not have the error.
  if (options.half_pixel_correction &&
      options.workspace.input_type == InputType::kDense) {
    Report(progress, "Correcting the half pixel", 0);
    *half_pixel = CorrectHalfPixel(options, &workspace);
  }
  return workspace;
}

void MeshWorkspace(const MesherOptions& options) {
  const std::filesystem::path output_path = FindOutputPath(options);
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  const auto progress = [&reporter](std::string_view stage, double share) {
    reporter.Update(stage, share);
  };
  std::optional<HalfPixelReport> half_pixel;
  Workspace workspace = ReadPoints(options, progress, &half_pixel);
  ManifoldMeshingOptions meshing = options.meshing;
  meshing.region =
      options.region.Resolve(workspace.views, workspace.sparse_points);
  const Masked masked =
      MaskWorkspace(options, meshing.region, progress, &workspace);
  reporter.Finish();
  PrintReport(workspace.report, workspace.views.size(), half_pixel, std::cout);
  PrintPixels(options, workspace);
  if (masked.report) {
    PrintReport(*masked.report, std::cout);
  }
  PrintReport(meshing.region, std::cout);
  std::cout << std::endl;
  const std::vector<View> views = MeshingViews(options, workspace);
  const ManifoldMesh mesh = MeshManifold(meshing, std::move(workspace.cloud),
                                         views, progress, masked.ends);
  Report(progress, "Writing the mesh", 0);
  WriteMesh(output_path, mesh.mesh, mesh.attributes);
  WriteFoundRegion(options.region, meshing.region, output_path);
  reporter.Finish();
  PrintReport(mesh.report, std::cout);
  PrintReport(reporter.StageTimes(), PeakMemory(), std::cout);
  std::cout << "\nWrote " << output_path.string() << " and "
            << VisibilityPath(output_path).string() << std::endl;
}

}  // namespace

int RunDelaunayManifoldMesher(int argc, char** argv) {
  MesherOptions options;
  CommandOptions command;
  AddMesherOptions(&command, &options);
  const CommandSteps steps = {[&options] { options.Finish(); },
                              &options.num_threads,
                              [&options] { MeshWorkspace(options); }};
  return RunCommand(argc, argv, command, steps, Advice());
}

}  // namespace colmap_ext
