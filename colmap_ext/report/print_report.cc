#include "colmap_ext/report/print_report.h"

#include <cstdint>
#include <ostream>
#include <string>

#include <fmt/format.h>

#include "colmap_ext/report/print_lines.h"

namespace colmap_ext {

namespace {

const char* MeaningOf(ImageOrderKind kind) {
  switch (kind) {
    case ImageOrderKind::kFile:
      return "as in images.bin, as COLMAP 3.8 - 3.10 have it";
    case ImageOrderKind::kImageId:
      return "by image_id, as COLMAP 3.11 has it";
    case ImageOrderKind::kFrame:
      return "as in frames.bin, as COLMAP 3.12+ have it";
    case ImageOrderKind::kFrameId:
      return "by frame_id, as COLMAP 3.12+ may have it";
  }
  return "";
}

const char* Describe(OrderReason reason) {
  switch (reason) {
    case OrderReason::kWanted:
      return "--image_order";
    case OrderReason::kOnlyOne:
      return "the only one there is";
    case OrderReason::kOnlyFit:
      return "the only one that fits";
    case OrderReason::kPositions:
      return "the best fit of the points";
    case OrderReason::kColors:
      return "the best fit of the colours";
  }
  return "";
}

void PrintOrder(const VerifiedOrder& verified, std::ostream& stream) {
  PrintText("image order of fused.ply.vis", MeaningOf(verified.order.kind),
            stream);
  PrintText("  told by", Describe(verified.reason), stream);
  PrintText("  points inside their images",
            fmt::format("{:12.2f} %", 100 * verified.evidence.inside), stream);
  PrintText("  ... and facing them",
            fmt::format("{:12.2f} %", 100 * verified.evidence.facing), stream);
}

void PrintCells(const ManifoldMeshingReport& report, std::ostream& stream) {
  PrintHeading("Cells", stream);
  Print("points in", static_cast<int64_t>(report.num_points), stream);
  Print("  at the place of another",
        static_cast<int64_t>(report.num_duplicate_points), stream);
  PrintIfAny("  outside of the region", report.num_outside_points, stream);
  PrintIfAny("rays beyond", report.num_ray_ends, stream);
  Print("observations", static_cast<int64_t>(report.num_observations), stream);
  Print("vertices, after thinning", static_cast<int64_t>(report.num_vertices),
        stream);
  Print("cells", static_cast<int64_t>(report.num_cells), stream);
  Print("  free", static_cast<int64_t>(report.num_free_cells), stream);
  PrintText("distance sigma", fmt::format("{:14.6g}", report.distance_sigma),
            stream);
  Print("rays walked", static_cast<int64_t>(report.rays.num_rays), stream);
  Print("  given up", static_cast<int64_t>(report.rays.num_lost_rays), stream);
  if (report.num_sharp_rays > 0) {
    Print("  strengthened", static_cast<int64_t>(report.num_sharp_rays),
          stream);
  }
  Print("facets crossed", static_cast<int64_t>(report.rays.num_steps), stream);
  Print("maximum flow", report.flow, stream);
  Print("minimum cut", report.cut, stream);
}

void PrintFixing(const ManifoldMeshingReport& report, std::ostream& stream) {
  PrintHeading("Singular vertices", stream);
  Print("of the cut", static_cast<int64_t>(report.fixing.num_singular_raw),
        stream);
  Print("after fixing", static_cast<int64_t>(report.fixing.num_singular_fixed),
        stream);
  Print("after the split",
        static_cast<int64_t>(report.mesh.num_singular_vertices), stream);
  Print("cells relabelled",
        static_cast<int64_t>(report.fixing.num_relabeled_cells), stream);
  Print("cells split", static_cast<int64_t>(report.fixing.num_split_cells),
        stream);
  Print("vertices split off", static_cast<int64_t>(report.num_split_vertices),
        stream);
  PrintIfAny("edges split", report.num_midpoints, stream);
}

void PrintMesh(const ManifoldMeshingReport& report, std::ostream& stream) {
  PrintHeading("Mesh", stream);
  PrintIfAny("long faces dropped", report.num_long_facets, stream);
  PrintIfAny("small components dropped", report.small_components.num_components,
             stream);
  PrintIfAny("  their faces", report.small_components.num_facets, stream);
  const SelfIntersectionRepair& repair = report.self_intersections;
  PrintIfAny("self-intersections removed", repair.num_before - repair.num_after,
             stream);
  PrintIfAny("self-intersections left", repair.num_after, stream);
  PrintReport(report.borders, stream);
  Print("faces", static_cast<int64_t>(report.mesh.num_facets), stream);
  Print("vertices", static_cast<int64_t>(report.mesh.num_vertices), stream);
  Print("components", static_cast<int64_t>(report.mesh.num_components), stream);
  Print("border loops", static_cast<int64_t>(report.mesh.num_border_loops),
        stream);
  Print("border edges", static_cast<int64_t>(report.mesh.num_border_edges),
        stream);
  Print("genus", report.mesh.genus, stream);
}

}  // namespace

void PrintReport(const WorkspaceReport& report, size_t num_images,
                 const std::optional<HalfPixelReport>& half_pixel,
                 std::ostream& stream) {
  PrintHeading("Workspace", stream);
  PrintText("folder", report.path.string(), stream);
  PrintText("sparse model", report.sparse_path.string(), stream);
  Print("images", static_cast<int64_t>(num_images), stream);
  PrintIfAny("  not there, camera's size taken", report.num_missing_images,
             stream);
  PrintIfAny("  scaled, other than their camera", report.num_rescaled_images,
             stream);
  Print("sparse points", static_cast<int64_t>(report.num_sparse_points),
        stream);
  Print("points read", static_cast<int64_t>(report.points.num_points), stream);
  Print("  dropped, not finite",
        static_cast<int64_t>(report.points.num_not_finite), stream);
  Print("  dropped, seen by no image",
        static_cast<int64_t>(report.points.num_without_views), stream);
  PrintIfAny("  list images that are not there", report.points.num_out_of_range,
             stream);
  PrintIfAny("  list an image twice", report.points.num_with_repeats, stream);
  if (report.is_order_verified) {
    PrintOrder(report.order, stream);
  }
  if (half_pixel) {
    const HalfPixelSlope& slope = half_pixel->slope;
    PrintText("half pixel, times, corrected",
              fmt::format("{:14.2f}", half_pixel->scale), stream);
    PrintText("  seen in the sparse points",
              slope.num_points > 0
                  ? fmt::format("{:14.2f} +- {:.2f}", slope.slope,
                                slope.standard_error)
                  : "             -  too few of them",
              stream);
  }
}

void PrintReport(const BorderReport& report, std::ostream& stream) {
  PrintIfAny("faces trimmed", report.trim.num_facets, stream);
  PrintIfAny("  not confident, in small gaps, kept",
             report.trim.num_kept_facets, stream);
  PrintIfAny("  cut off, dropped with them", report.trim.num_leftover_facets,
             stream);
  PrintIfAny("holes closed", report.holes.num_closed, stream);
  PrintIfAny("  by faces", report.holes.num_facets, stream);
  PrintIfAny("  by faces that intersect others", report.holes.num_intersecting,
             stream);
  PrintIfAny("holes left, would not be manifold", report.holes.NumLeft(),
             stream);
}

void PrintReport(const MaskReport& report, std::ostream& stream) {
  Print("masks", static_cast<int64_t>(report.num_masks), stream);
  Print("  masked views of points",
        static_cast<int64_t>(report.num_masked_observations), stream);
  Print("  points masked in all views",
        static_cast<int64_t>(report.num_masked_points), stream);
}

void PrintReport(const std::optional<Region>& region, std::ostream& stream) {
  if (!region) {
    return;
  }
  const Eigen::Vector3d& center = region->center;
  const Eigen::Vector3d size = 2 * region->half_sizes;
  PrintText(
      "region, its centre",
      fmt::format("{:14.6g} {:.6g} {:.6g}", center.x(), center.y(), center.z()),
      stream);
  PrintText("  its size",
            fmt::format("{:14.6g} {:.6g} {:.6g}", size.x(), size.y(), size.z()),
            stream);
}

void PrintReport(const ManifoldMeshingReport& report, std::ostream& stream) {
  PrintCells(report, stream);
  PrintFixing(report, stream);
  PrintMesh(report, stream);
}

void PrintReport(const std::vector<StageTime>& stage_times, size_t peak_memory,
                 std::ostream& stream) {
  PrintHeading("Time", stream);
  double total = 0;
  for (const StageTime& time : stage_times) {
    PrintText(time.stage, fmt::format("{:12.2f} s", time.seconds), stream);
    total += time.seconds;
  }
  PrintText("all", fmt::format("{:12.2f} s", total), stream);
  PrintText("peak memory", fmt::format("{:11.0f} MB", peak_memory / 1e6),
            stream);
  stream << std::flush;
}

}  // namespace colmap_ext
