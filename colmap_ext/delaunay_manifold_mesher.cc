#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/options/add_meshing_options.h"
#include "colmap_ext/report/page_pictures.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/run_pages.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/write_mesh.h"
#include "meshing/manifold_meshing.h"
#include "scene/half_pixel.h"
#include "workspace/find_workspace.h"
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
  if (!options.report_path.empty()) {
    ExpectWritable(options.report_path);
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
void PrintPixels(const MesherOptions& options, const Workspace& workspace,
                 ReportLog* log) {
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
        log);
  }
}

PagePictures Draw(const Workspace& workspace, const ManifoldMesh& mesh) {
  const PageCameras cameras = ChoosePageCameras(
      workspace.views, mesh.attributes.views, workspace.report.path / "images",
      ColmapPictureDecoder());
  return DrawMeshing(cameras, workspace.cloud, mesh);
}

void MeshWorkspace(const MesherOptions& options,
                   const std::vector<PageOption>& page_options) {
  const std::filesystem::path output_path = FindOutputPath(options);
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  const auto progress = [&reporter](std::string_view stage, double share) {
    reporter.Update(stage, share);
  };
  Report(progress, "Reading the workspace", 0);
  Workspace workspace = ReadWorkspace(options.InputPath(), options.workspace,
                                      ColmapPictureDecoder());
  std::optional<HalfPixelReport> half_pixel;
  // Sparse points come from features, which do not have the error.
  if (options.half_pixel_correction &&
      options.workspace.input_type == InputType::kDense) {
    Report(progress, "Correcting the half pixel", 0);
    half_pixel = CorrectHalfPixel(options, &workspace);
  }
  reporter.Finish();
  ReportLog log(&std::cout);
  PrintReport(workspace.report, workspace.views.size(), half_pixel, &log);
  PrintPixels(options, workspace, &log);
  std::cout << std::endl;
  const ManifoldMesh mesh =
      MeshManifold(options.meshing, workspace.cloud,
                   MeshingViews(options, workspace), progress);
  Report(progress, "Writing the mesh", 0);
  WriteMesh(output_path, mesh.mesh, mesh.attributes);
  PagePictures pictures;
  if (!options.report_path.empty()) {
    Report(progress, "Drawing the report", 0);
    pictures = Draw(workspace, mesh);
  }
  reporter.Finish();
  PrintReport(mesh.report, &log);
  PrintReport(reporter.StageTimes(), PeakMemory(), &log);
  if (!options.report_path.empty()) {
    WriteText(options.report_path,
              MeshingPage({"delaunay_manifold_mesher", output_path.string(),
                           Versions(), page_options},
                          log, pictures));
  }
  std::cout << "\nWrote " << output_path.string() << " and "
            << VisibilityPath(output_path).string() << std::endl;
}

}  // namespace

int RunDelaunayManifoldMesher(int argc, char** argv) {
  MesherOptions options;
  CommandOptions command;
  AddMesherOptions(&command, &options);
  const CommandSteps steps = {
      [&options] { options.Finish(); }, &options.num_threads,
      [&options, &command] { MeshWorkspace(options, PageOptions(command)); }};
  return RunCommand(argc, argv, command, steps, Advice());
}

}  // namespace colmap_ext
