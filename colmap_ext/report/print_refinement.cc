#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "workspace/usable_pictures.h"

namespace colmap_ext {

namespace {

void PrintCount(const char* label, size_t count, std::ostream& stream) {
  Print(label, static_cast<int64_t>(count), stream);
}

void PrintRepair(const ManifoldRepair& repair, std::ostream& stream) {
  PrintText("not manifold, so it was split", "", stream);
  PrintIfAny("  faces dropped, vertex not finite", repair.num_invalid_facets,
             stream);
  PrintIfAny("  faces dropped, repeat a vertex", repair.num_degenerate_facets,
             stream);
  PrintIfAny("  faces dropped, there twice", repair.num_duplicate_facets,
             stream);
  PrintIfAny("  vertices dropped, of no face", repair.num_unused_vertices,
             stream);
  PrintCount("  vertices split off", repair.num_split_vertices, stream);
  PrintIfAny("  edges split", repair.num_midpoints, stream);
}

void PrintLabelings(const RefinementReport& report, std::ostream& stream) {
  PrintHeading("Labels", stream);
  PrintText("", "         pairs  faces without        energy ->", stream);
  for (const LabelingReport& labeling : report.labelings) {
    PrintText(LevelName(labeling.level),
              fmt::format("{:14}{:15}{:14.6g} -> {:.6g} (>= {:.6g})",
                          labeling.num_pairs, labeling.num_unlabeled_facets,
                          labeling.initial_energy, labeling.final_energy,
                          labeling.lower_bound),
              stream);
  }
  if (!report.labelings.empty() && !report.steps.empty() &&
      2 * report.labelings.back().num_unlabeled_facets >
          report.steps.back().num_facets) {
    stream << "WARNING: no pair of images sees most of the faces; is the mesh "
              "of another workspace, or inside out?\n";
  }
}

void PrintStages(const RefinementReport& report, std::ostream& stream) {
  PrintHeading("Refinement", stream);
  PrintText("", "    iterations         faces", stream);
  for (const auto& stage : SplitIntoStages(report.steps)) {
    const RefinementStep& first = stage.front();
    const RefinementStep& last = stage.back();
    PrintText(StageName(last),
              fmt::format("{:14}{:14}", last.iteration - first.iteration,
                          last.num_facets),
              stream);
    PrintText("  energy",
              fmt::format("{:14.6g} -> {:.6g}", first.energy, last.energy),
              stream);
    PrintText(
        "  mean ZNCC",
        fmt::format("{:14.4f} -> {:.4f}", first.mean_zncc, last.mean_zncc),
        stream);
  }
  PrintCount("steps shortened", report.num_shortened_steps, stream);
  PrintIfAny("solutions that did not converge",
             report.num_unconverged_solutions, stream);
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
        stages.back().back().is_final != step.is_final) {
      stages.emplace_back();
    }
    stages.back().push_back(step);
  }
  return stages;
}

std::string StageName(const RefinementStep& step) {
  return LevelName(step.level) + (step.is_final ? ", final" : "");
}

std::string Describe(const RefinementStep& step) {
  return fmt::format(
      "{}, iteration {}: energy {:.6g}, ZNCC {:.4f}, step {:.3f} px",
      StageName(step), step.iteration, step.energy, step.mean_zncc,
      step.mean_step);
}

void PrintReport(const RefinementInput& input, std::ostream& stream) {
  PrintReport(input.workspace, input.views.size(), std::nullopt, stream);
  const std::string errors = DescribeErrors(input.views, input.picture_errors);
  if (!errors.starts_with("0 ")) {
    PrintText("images left out", errors, stream);
  }
  if (input.masks) {
    PrintReport(*input.masks, stream);
  }
  PrintHeading("Input mesh", stream);
  PrintReport(input.region, stream);
  if (input.repair) {
    PrintRepair(*input.repair, stream);
  }
  PrintCount("faces", input.mesh.facets.size(), stream);
  PrintCount("vertices", input.mesh.vertices.size(), stream);
  PrintText("images that see them, from",
            input.has_visibility ? "its .vis" : "the nearest fused points",
            stream);
  PrintText("colours, from", input.colors_from, stream);
  if (!input.has_fused_points) {
    PrintText("no fused.ply", "pairs of images by the mesh's vertices", stream);
  }
}

void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 std::ostream& stream) {
  PrintLabelings(report, stream);
  PrintStages(report, stream);
  PrintHeading("Mesh", stream);
  PrintReport(report.borders, stream);
  PrintCount("faces", mesh.num_facets, stream);
  PrintCount("vertices", mesh.num_vertices, stream);
  PrintCount("components", mesh.num_components, stream);
  PrintCount("border edges", mesh.num_border_edges, stream);
  Print("genus", mesh.genus, stream);
  PrintCount("flipped faces", report.num_flipped_facets, stream);
  PrintIfAny("self-intersections removed",
             report.num_removed_self_intersections, stream);
  PrintCount("self-intersections", report.num_self_intersections, stream);
}

}  // namespace colmap_ext
