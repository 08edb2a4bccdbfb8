#include "colmap_ext/report/print_report.h"

namespace colmap_ext {
namespace {

constexpr int kLabelWidth = 38;  // characters

void PrintOrder(const VerifiedOrder& verified, ReportLog* log) {
  // Of an ImageOrderKind, and of an OrderReason.
  constexpr const char* kMeanings[] = {
      "as in images.bin (COLMAP 3.8 - 3.10)", "by image_id (COLMAP 3.11)",
      "as in frames.bin (COLMAP 3.12+)", "by frame_id (COLMAP 3.12+)"};
  constexpr const char* kReasons[] = {
      "--image_order", "the only one possible", "the only one that fits",
      "the best fit of the points", "the best fit of the colors"};
  PrintText("image order of fused.ply.vis",
            kMeanings[static_cast<int>(verified.order.kind)], log);
  PrintText("  determined by", kReasons[static_cast<int>(verified.reason)],
            log);
  PrintText("  points inside their images",
            fmt::format("{:12.2f} %", 100 * verified.evidence.inside), log);
  PrintText("  ... and facing them",
            fmt::format("{:12.2f} %", 100 * verified.evidence.facing), log);
}

void PrintCells(const ManifoldMeshingReport& report, ReportLog* log) {
  PrintHeading("Cells", log);
  Print("points in", report.num_points, log);
  Print("  at the place of another", report.num_duplicate_points, log);
  PrintIfAny("  outside of the region", report.num_outside_points, log);
  PrintIfAny("  of weaker layers of walls", report.num_weaker_points, log);
  PrintIfAny("rays beyond", report.num_ray_ends, log);
  PrintIfAny("rays to depth maps", report.num_depth_rays, log);
  Print("observations", report.num_observations, log);
  Print("vertices, after thinning", report.num_vertices, log);
  Print("cells", report.num_cells, log);
  Print("  free", report.num_free_cells, log);
  PrintNumber("distance sigma", report.distance_sigma, log);
  Print("rays walked", report.rays.num_rays, log);
  Print("  given up", report.rays.num_lost_rays, log);
  Print("cell faces crossed", report.rays.num_steps, log);
  Print("maximum flow", report.flow, log);
  Print("minimum cut", report.cut, log);
}

void PrintFixing(const ManifoldMeshingReport& report, ReportLog* log) {
  PrintHeading("Singular vertices", log);
  Print("of the cut", report.fixing.num_singular_raw, log);
  Print("after fixing", report.fixing.num_singular_fixed, log);
  Print("after the split", report.mesh.num_singular_vertices, log);
  Print("cells relabeled", report.fixing.num_relabeled_cells, log);
  Print("cells split", report.fixing.num_split_cells, log);
  Print("vertices split off", report.num_split_vertices, log);
  PrintIfAny("edges split", report.num_midpoints, log);
}

void PrintMesh(const ManifoldMeshingReport& report, ReportLog* log) {
  PrintHeading("Mesh", log);
  PrintIfAny("long faces dropped", report.num_long_facets, log);
  PrintIfAny("small components dropped", report.num_small_components, log);
  PrintIfAny("vertices smoothed", report.smoothing.num_moved, log);
  const SelfIntersectionRepair& repair = report.self_intersections;
  PrintIfAny("self-intersections removed", repair.num_before - repair.num_after,
             log);
  PrintIfAny("self-intersections left", repair.num_after, log);
  PrintReport(report.borders, log);
  PrintTopology(report.mesh, log);
}

}  // namespace

void PrintHeading(const std::string& heading, ReportLog* log) {
  *log->stream << "\n" << heading << "\n";
  log->sections.push_back({heading, {}});
}

void PrintText(const std::string& label, const std::string& text,
               ReportLog* log) {
  *log->stream << fmt::format("  {:<{}}{}\n", label, kLabelWidth, text);
  if (log->sections.empty()) {
    log->sections.emplace_back();
  }
  log->sections.back().rows.push_back({label, text});
}

void PrintNumber(const std::string& label, double number, ReportLog* log,
                 std::optional<int> decimals) {
  PrintText(label,
            decimals ? fmt::format("{:14.{}f}", number, *decimals)
                     : fmt::format("{:14.6g}", number),
            log);
}

void PrintWarning(const std::string& what, ReportLog* log) {
  *log->stream << "WARNING: " << what << "\n";
  log->warnings.push_back(what);
}

void PrintTopology(const MeshReport& mesh, ReportLog* log) {
  Print("faces", mesh.num_facets, log);
  Print("vertices", mesh.num_vertices, log);
  Print("components", mesh.num_components, log);
  Print("border loops", mesh.num_border_loops, log);
  Print("border edges", mesh.num_border_edges, log);
  if (mesh.IsManifold()) {
    Print("genus", mesh.genus, log);
  }
}

void PrintReport(const WorkspaceReport& report, size_t num_images,
                 const std::optional<HalfPixelReport>& half_pixel,
                 ReportLog* log) {
  PrintHeading("Workspace", log);
  PrintText("folder", report.path.string(), log);
  PrintText("sparse model", report.sparse_path.string(), log);
  Print("images", num_images, log);
  PrintIfAny("  missing, their camera's size is used",
             report.num_missing_images, log);
  PrintIfAny("  scaled, other than their camera", report.num_rescaled_images,
             log);
  Print("sparse points", report.num_sparse_points, log);
  Print("points read", report.points.num_points, log);
  Print("  dropped, not finite", report.points.num_not_finite, log);
  Print("  dropped, seen by no image", report.points.num_without_views, log);
  PrintIfAny("  list missing images", report.points.num_out_of_range, log);
  PrintIfAny("  list an image twice", report.points.num_with_repeats, log);
  if (report.is_order_verified) {
    PrintOrder(report.order, log);
  }
  if (half_pixel) {
    const HalfPixelSlope& slope = half_pixel->slope;
    PrintNumber("half pixel, times, corrected", half_pixel->scale, log, 2);
    PrintText("  seen in the sparse points",
              slope.num_points > 0
                  ? fmt::format("{:14.2f} +- {:.2f}", slope.slope,
                                slope.standard_error)
                  : "             -  too few of them",
              log);
  }
}

void PrintFootprint(double footprint, ReportLog* log) {
  PrintNumber("a pixel on it, scene units", footprint, log);
}

void PrintReport(const BorderReport& report, ReportLog* log) {
  PrintIfAny("faces trimmed", report.trim.num_facets, log);
  PrintIfAny("  small or cut off", report.trim.num_leftover_facets, log);
  PrintIfAny("faces kept, not confident", report.trim.num_kept_facets, log);
  PrintIfAny("holes closed", report.holes.num_closed, log);
  PrintIfAny("  by faces", report.holes.num_facets, log);
  PrintIfAny("  by faces that intersect others", report.holes.num_intersecting,
             log);
  PrintIfAny("holes left open", report.holes.NumLeft(), log);
}

void PrintReport(const std::optional<MaskReport>& report, ReportLog* log) {
  if (!report) {
    return;
  }
  Print("masks", report->num_masks, log);
  Print("  masked views of points", report->num_masked_observations, log);
  Print("  points masked in all views", report->num_masked_points, log);
}

void PrintReport(const std::optional<Region>& region, ReportLog* log) {
  if (!region) {
    return;
  }
  const auto print = [&](const char* label, const Eigen::Vector3d& v) {
    PrintText(label, fmt::format("{:14.6g} {:.6g} {:.6g}", v.x(), v.y(), v.z()),
              log);
  };
  print("region, center", region->center);
  print("  size", 2 * region->half_sizes);
}

void PrintReport(const ManifoldMeshingReport& report, ReportLog* log) {
  if (report.num_points > 0) {  // else they were cut in tiles
    PrintCells(report, log);
  }
  PrintFixing(report, log);
  PrintMesh(report, log);
}

void Console::PrintTime() {
  PrintHeading("Time", &log);
  double total = 0;
  for (const StageTime& time : reporter.StageTimes()) {
    PrintText(time.stage, fmt::format("{:12.2f} s", time.seconds), &log);
    total += time.seconds;
  }
  PrintText("all", fmt::format("{:12.2f} s", total), &log);
  PrintText("peak memory", fmt::format("{:11.0f} MB", PeakMemory() / 1e6),
            &log);
}

}  // namespace colmap_ext
