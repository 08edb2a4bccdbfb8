#include "colmap_ext/report/print_report.h"

#include <algorithm>
#include <cstdint>
#include <functional>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

void PrintRepair(const ManifoldRepair& repair, ReportLog* log) {
  PrintText("not manifold: split", "", log);
  PrintIfAny("  faces dropped, vertex not finite", repair.num_invalid_facets,
             log);
  PrintIfAny("  faces dropped, repeat a vertex", repair.num_degenerate_facets,
             log);
  PrintIfAny("  duplicate faces dropped", repair.num_duplicate_facets, log);
  PrintIfAny("  vertices dropped, of no face", repair.num_unused_vertices, log);
  Print("  vertices split off", repair.num_split_vertices, log);
  PrintIfAny("  edges split", repair.num_midpoints, log);
}

void PrintLabelings(const RefinementReport& report, ReportLog* log) {
  PrintHeading("Labels", log);
  PrintText("", "         pairs  faces without        energy ->", log);
  for (const LabelingReport& labeling : report.labelings) {
    PrintText(LevelName(labeling.level),
              fmt::format("{:14}{:15}{:14.6g} -> {:.6g} (>= {:.6g})",
                          labeling.num_pairs, labeling.num_unlabeled_facets,
                          labeling.initial_energy, labeling.final_energy,
                          labeling.lower_bound),
              log);
  }
  if (!report.labelings.empty() && !report.steps.empty() &&
      2 * report.labelings.back().num_unlabeled_facets >
          report.steps.back().num_facets) {
    PrintWarning(
        "no pair of images sees most of the faces; is the mesh of another "
        "workspace, or inside out?",
        log);
  }
}

void PrintStages(const RefinementReport& report, ReportLog* log) {
  PrintHeading("Refinement", log);
  PrintText("", "    iterations         faces", log);
  for (const StageText& stage : DescribeStages(report.steps)) {
    PrintText(stage.name,
              fmt::format("{:>14}{:>14}", stage.iterations, stage.faces), log);
    PrintText("  energy",
              fmt::format("{:>14} -> {}", stage.energy[0], stage.energy[1]),
              log);
    PrintText(
        "  mean ZNCC",
        fmt::format("{:>14} -> {}", stage.mean_zncc[0], stage.mean_zncc[1]),
        log);
  }
}

// px in the image. An image that moves farther was placed wrongly before, or is
// now.
constexpr double kFarMotion = 3;
// px of the last level's images. Poses that move farther in the last round have
// not converged.
constexpr double kConverged = 0.05;

// Warns of the views for which `is_listed` of their index holds, if any.
void Warn(const std::vector<View>& views, const std::string& what,
          const std::function<bool(size_t)>& is_listed, ReportLog* log) {
  std::string list;
  for (size_t i = 0; i < views.size(); ++i) {
    list += is_listed(i) ? " " + views[i].name : "";
  }
  if (!list.empty()) {
    PrintWarning(what + ":" + list, log);
  }
}

using Steps = std::vector<RefinementStep>;

// All sizes in px.
constexpr double kStepWidth = 24;
constexpr double kMinPanelWidth = 190;
constexpr double kPanelHeight = 200;
constexpr double kMargin = 24;   // around everything, and between panels
constexpr double kPadding = 14;  // of a curve in its panel
constexpr double kTop = 64;      // of the panels
constexpr double kHeight = kTop + kPanelHeight + 48;

std::string EnergyText(double energy) { return fmt::format("{:.6g}", energy); }

std::string ZnccText(double zncc) { return fmt::format("{:.4f}", zncc); }

double PanelWidth(const Steps& steps) {
  return std::max(
      kMinPanelWidth,
      2 * kPadding + kStepWidth * (static_cast<double>(steps.size()) - 1));
}

std::string Text(double x, double y, const char* anchor,
                 const std::string& text) {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y,
      anchor, text);
}

// The curve of one stage in a panel that starts at `left`.
std::string Panel(const Steps& steps, double left) {
  const auto [low, high] =
      std::ranges::minmax_element(steps, {}, &RefinementStep::mean_zncc);
  const double highest = high->mean_zncc;
  const double range = std::max(highest - low->mean_zncc, 1e-300);
  const double width = PanelWidth(steps);
  const double step_width =
      (width - 2 * kPadding) /
      std::max(1.0, static_cast<double>(steps.size()) - 1);
  std::string points;
  std::string dots;
  for (size_t i = 0; i < steps.size(); ++i) {
    const double x = left + kPadding + step_width * static_cast<double>(i);
    const double y =
        kTop + kPadding +
        (kPanelHeight - 2 * kPadding) * (highest - steps[i].mean_zncc) / range;
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    dots +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>\n", x, y);
  }
  const double right = left + width;
  const double below = kTop + kPanelHeight + 16;
  return fmt::format(
             "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
             "height=\"{:.1f}\" fill=\"#f4f4f4\"/>\n",
             left, kTop, width, kPanelHeight) +
         "<polyline points=\"" + points +
         "\" fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.5\"/>\n" +
         "<g fill=\"#1f5fa8\">\n" + dots + "</g>\n" +
         Text(left, kTop - 8, "start", StageName(steps[0])) +
         Text(left, below, "start", ZnccText(steps.front().mean_zncc)) +
         Text(right, below, "end", ZnccText(steps.back().mean_zncc)) +
         Text(left + width / 2, below + 16, "middle",
              fmt::format("{} iterations",
                          steps.back().iteration - steps.front().iteration));
}

}  // namespace

std::string LevelName(int level) {
  return level == 0 ? "full size"
                    : fmt::format("1/{} size", int64_t{1} << level);
}

std::vector<std::vector<RefinementStep>> SplitIntoStages(
    const std::vector<RefinementStep>& steps) {
  std::vector<std::vector<RefinementStep>> stages;
  for (const RefinementStep& step : steps) {
    if (stages.empty() || stages.back().back().level != step.level ||
        stages.back().back().is_final != step.is_final ||
        stages.back().back().num_pairs != step.num_pairs) {
      stages.emplace_back();
    }
    stages.back().push_back(step);
  }
  return stages;
}

std::string StageName(const RefinementStep& step) {
  return LevelName(step.level) +
         (step.is_final ? fmt::format(", final, {} pairs", step.num_pairs)
                        : "");
}

std::vector<StageText> DescribeStages(
    const std::vector<RefinementStep>& steps) {
  std::vector<StageText> texts;
  for (const auto& stage : SplitIntoStages(steps)) {
    const RefinementStep& first = stage.front();
    const RefinementStep& last = stage.back();
    texts.push_back({StageName(last),
                     std::to_string(last.iteration - first.iteration),
                     std::to_string(last.num_facets),
                     {EnergyText(first.energy), EnergyText(last.energy)},
                     {ZnccText(first.mean_zncc), ZnccText(last.mean_zncc)}});
  }
  return texts;
}

std::string Describe(const RefinementStep& step) {
  return fmt::format(
      "{}, iteration {}: energy {:.6g}, ZNCC {:.4f}, step {:.3f} px",
      StageName(step), step.iteration, step.energy, step.mean_zncc,
      step.mean_step);
}

void PrintReport(const RefinementInput& input, ReportLog* log) {
  PrintReport(input.workspace, input.views.size(), std::nullopt, log);
  const std::string errors = DescribeErrors(input.views, input.picture_errors);
  if (!errors.starts_with("0 ")) {
    PrintText("images ignored", errors, log);
  }
  PrintReport(input.masks, log);
  PrintHeading("Input mesh", log);
  PrintReport(input.region, log);
  if (input.repair) {
    PrintRepair(*input.repair, log);
  }
  Print("faces", input.mesh.facets.size(), log);
  Print("vertices", input.mesh.vertices.size(), log);
  PrintText("images that see them, from",
            input.has_visibility ? "its .vis" : "the nearest fused points",
            log);
  PrintText("colors, from", input.colors_from, log);
  if (!input.has_fused_points) {
    PrintText("no fused.ply", "pairs of images by the mesh's vertices", log);
  }
}

void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 ReportLog* log) {
  PrintLabelings(report, log);
  PrintStages(report, log);
  PrintHeading("Mesh", log);
  PrintReport(report.borders, log);
  PrintTopology(mesh, log);
  PrintIfAny("self-intersections removed",
             report.num_removed_self_intersections, log);
  Print("self-intersections", report.num_self_intersections, log);
}

std::string Describe(const CameraRefinementReport& report) {
  return fmt::format(
      "{}, cameras: {} rounds, {} windows, ZNCC {:.4f} -> {:.4f}, moved by "
      "{:.3f} px at most",
      LevelName(report.level), report.num_rounds, report.num_windows,
      report.mean_zncc_before, report.mean_zncc, report.total_motion);
}

void PrintReport(const CameraAlignment& alignment,
                 const std::vector<View>& views, ReportLog* log) {
  const Misalignment& misalignment = alignment.misalignment;
  PrintHeading("Alignment of the images", log);
  PrintNumber("off by, px of the surface", misalignment.by_cameras, log, 3);
  PrintNumber("the surface before, px", misalignment.of_surface, log, 3);
  double largest = 0;
  for (size_t i = 0; i < misalignment.radial_shifts.size(); ++i) {
    for (const double shift : misalignment.radial_shifts[i]) {
      largest = std::max(largest, std::abs(shift) * HalfDiagonal(views[i]));
    }
  }
  PrintNumber("errors of the lens, px", largest, log, 3);
  const std::vector<uint32_t> misaligned = MisalignedViews(misalignment);
  Warn(
      views, "these images fit the others worse than the surface fits",
      [&](size_t i) { return std::ranges::count(misaligned, i) > 0; }, log);
  if (!alignment.IsRefined()) {
    return;
  }
  const CameraRefinementReport& report = alignment.refinements.back();
  PrintHeading("Cameras", log);
  PrintNumber("noise of the features, px", report.track_sigma, log, 3);
  PrintText("", "      moved by, px       windows      features", log);
  for (size_t i = 0; i < views.size(); ++i) {
    const RefinedView& view = report.views[i];
    PrintText(views[i].name,
              fmt::format("{:18.3f}{:14}{:14}", view.motion, view.num_windows,
                          view.num_observations),
              log);
  }
  Warn(
      views, fmt::format("these images moved by more than {} px", kFarMotion),
      [&](size_t i) { return report.views[i].motion > kFarMotion; }, log);
  Warn(
      views, "these images did not converge",
      [&](size_t i) { return report.views[i].last_motion > kConverged; }, log);
  Warn(
      views, "too little is seen by these images to refine them",
      [&](size_t i) { return report.views[i].is_skipped; }, log);
}

std::string StepsCsv(const std::vector<RefinementStep>& steps) {
  std::string csv =
      "level,final,iteration,energy,photometric_energy,mean_zncc,mean_step_px,"
      "seconds,vertices,faces,pairs\n";
  for (const RefinementStep& step : steps) {
    csv += fmt::format(
        "{},{:d},{},{:.9g},{:.9g},{:.6g},{:.6g},{:.3f},{},{},{}\n", step.level,
        step.is_final, step.iteration, step.energy, step.photometric_energy,
        step.mean_zncc, step.mean_step, step.seconds, step.num_vertices,
        step.num_facets, step.num_pairs);
  }
  return csv;
}

std::string StepsFigure(const std::vector<RefinementStep>& steps) {
  double left = kMargin;
  std::string panels;
  for (const Steps& stage : SplitIntoStages(steps)) {
    panels += Panel(stage, left);
    left += PanelWidth(stage) + kMargin;
  }
  const double width = std::max(left, 2 * kMargin + kMinPanelWidth);
  return fmt::format(
             "<svg role=\"img\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\" ",
             width, kHeight) +
         "font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
         Text(kMargin, 28, "start", "Mean ZNCC by iteration") + panels +
         "</svg>\n";
}

}  // namespace colmap_ext
