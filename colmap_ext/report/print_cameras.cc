#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/refinement_report.h"

namespace colmap_ext {

namespace {

// Px in the picture: an image that moves by more was not placed by its
// features, or is matched to something else now.
constexpr double kFarMotion = 3;
// Px of the last level's images, in the last round: above it, the poses have
// not converged.
constexpr double kConverged = 0.05;

void Warn(const std::vector<std::string>& names, const std::string& what,
          ReportLog* log) {
  if (names.empty()) {
    return;
  }
  std::string list;
  for (const std::string& name : names) {
    list += " " + name;
  }
  PrintWarning(what + ":" + list, log);
}

}  // namespace

std::string Describe(const CameraRefinementReport& report) {
  return fmt::format(
      "{}, cameras: {} rounds, {} windows, ZNCC {:.4f} -> {:.4f}, moved by "
      "{:.3f} px at most",
      LevelName(report.level), report.num_rounds, report.num_windows,
      report.mean_zncc_before, report.mean_zncc, report.total_motion);
}

void PrintReport(const Misalignment& misalignment,
                 const std::vector<View>& views, ReportLog* log) {
  PrintHeading("Alignment of the images", log);
  PrintText("off by, px of the surface",
            fmt::format("{:14.3f}", misalignment.by_cameras), log);
  PrintText("the surface before, px",
            fmt::format("{:14.3f}", misalignment.of_surface), log);
  std::vector<std::string> misaligned;
  for (const uint32_t view : MisalignedViews(misalignment)) {
    misaligned.push_back(views[view].name);
  }
  Warn(misaligned, "these images fit the others worse than the surface fits",
       log);
}

void PrintReport(const CameraRefinementReport& report,
                 const std::vector<View>& views, ReportLog* log) {
  PrintHeading("Cameras", log);
  PrintText("noise of the features, px",
            fmt::format("{:14.3f}", report.track_sigma), log);
  PrintText("", "      moved by, px       windows      features", log);
  std::vector<std::string> far;
  std::vector<std::string> unsettled;
  std::vector<std::string> skipped;
  for (size_t i = 0; i < views.size(); ++i) {
    const RefinedView& view = report.views[i];
    PrintText(views[i].name,
              fmt::format("{:18.3f}{:14}{:14}", view.motion, view.num_windows,
                          view.num_observations),
              log);
    if (view.motion > kFarMotion) {
      far.push_back(views[i].name);
    }
    if (view.last_motion > kConverged) {
      unsettled.push_back(views[i].name);
    }
    if (view.is_skipped) {
      skipped.push_back(views[i].name);
    }
  }
  Warn(far, fmt::format("these images moved by more than {} px", kFarMotion),
       log);
  Warn(unsettled, "these images did not converge", log);
  Warn(skipped, "too little is seen by these images to refine them", log);
}

}  // namespace colmap_ext
