#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "workspace/usable_pictures.h"

namespace colmap_ext {

namespace {

void PrintCount(const char* label, size_t count, ReportLog* log) {
  Print(label, static_cast<int64_t>(count), log);
}

void PrintRepair(const ManifoldRepair& repair, ReportLog* log) {
  PrintText("not manifold, so it was split", "", log);
  PrintIfAny("  faces dropped, vertex not finite", repair.num_invalid_facets,
             log);
  PrintIfAny("  faces dropped, repeat a vertex", repair.num_degenerate_facets,
             log);
  PrintIfAny("  faces dropped, there twice", repair.num_duplicate_facets, log);
  PrintIfAny("  vertices dropped, of no face", repair.num_unused_vertices, log);
  PrintCount("  vertices split off", repair.num_split_vertices, log);
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
  PrintCount("steps shortened", report.num_shortened_steps, log);
  PrintIfAny("solutions that did not converge",
             report.num_unconverged_solutions, log);
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
  const auto energy = [](const RefinementStep& step) {
    return fmt::format("{:.6g}", step.energy);
  };
  const auto mean_zncc = [](const RefinementStep& step) {
    return fmt::format("{:.4f}", step.mean_zncc);
  };
  std::vector<StageText> texts;
  for (const auto& stage : SplitIntoStages(steps)) {
    const RefinementStep& first = stage.front();
    const RefinementStep& last = stage.back();
    texts.push_back({StageName(last),
                     std::to_string(last.iteration - first.iteration),
                     std::to_string(last.num_facets),
                     {energy(first), energy(last)},
                     {mean_zncc(first), mean_zncc(last)}});
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
    PrintText("images left out", errors, log);
  }
  if (input.masks) {
    PrintReport(*input.masks, log);
  }
  PrintHeading("Input mesh", log);
  PrintReport(input.region, log);
  if (input.repair) {
    PrintRepair(*input.repair, log);
  }
  PrintCount("faces", input.mesh.facets.size(), log);
  PrintCount("vertices", input.mesh.vertices.size(), log);
  PrintText("images that see them, from",
            input.has_visibility ? "its .vis" : "the nearest fused points",
            log);
  PrintText("colours, from", input.colors_from, log);
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
  PrintCount("faces", mesh.num_facets, log);
  PrintCount("vertices", mesh.num_vertices, log);
  PrintCount("components", mesh.num_components, log);
  PrintCount("border edges", mesh.num_border_edges, log);
  Print("genus", mesh.genus, log);
  PrintCount("flipped faces", report.num_flipped_facets, log);
  PrintIfAny("self-intersections removed",
             report.num_removed_self_intersections, log);
  PrintCount("self-intersections", report.num_self_intersections, log);
}

}  // namespace colmap_ext
