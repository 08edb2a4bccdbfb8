#pragma once

#include <unistd.h>

#include <concepts>
#include <cstddef>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/terminal/terminal.h"
#include "evaluation/mesh_evaluation.h"
#include "mesh/topology.h"
#include "meshing/manifold_meshing.h"
#include "refine/facetwise_refinement.h"
#include "repair/borders.h"
#include "scene/half_pixel.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "workspace/read_pictures.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// One fact. Columns of numbers in the text are aligned by blanks.
struct ReportRow {
  std::string label;
  std::string text;
};

struct ReportSection {
  std::string heading;
  std::vector<ReportRow> rows;
};

// A report: printed as it grows, and kept for the page.
struct ReportLog {
  // \param printed  the stream to print to; outlives the log.
  explicit ReportLog(std::ostream* printed) : stream(printed) {}

  std::ostream* stream;
  std::vector<ReportSection> sections;
  std::vector<std::string> warnings;
  const CommandOptions* command = nullptr;  // whose options the page lists
};

// Print the lines of a report: one fact a line, numbers in one column.

void PrintHeading(const std::string& heading, ReportLog* log);

void PrintText(const std::string& label, const std::string& text,
               ReportLog* log);

// \param decimals  digits after the point; nullopt: six significant digits.
void PrintNumber(const std::string& label, double number, ReportLog* log,
                 std::optional<int> decimals = std::nullopt);

void Print(const std::string& label, std::integral auto number,
           ReportLog* log) {
  PrintText(label, fmt::format("{:14}", number), log);
}

void PrintIfAny(const std::string& label, std::integral auto number,
                ReportLog* log) {
  if (number > 0) {
    Print(label, number, log);
  }
}

void PrintWarning(const std::string& what, ReportLog* log);

// What a command shows: its progress, then its report.
struct Console {
  ProgressReporter reporter{std::cout, isatty(STDOUT_FILENO) != 0};
  Progress progress = [this](std::string_view stage, double share) {
    reporter.Update(stage, share);
  };
  ReportLog log{&std::cout};

  // Ends the report with the times of the stages and the peak memory.
  void PrintTime();
};

struct HalfPixelReport {
  HalfPixelSlope slope;
  double scale = 1;  // of the correction
};

// The input: what was read, dropped, and why.
// \param half_pixel  if the half pixel was corrected.
void PrintReport(const WorkspaceReport& report, size_t num_images,
                 const std::optional<HalfPixelReport>& half_pixel,
                 ReportLog* log);

// The masked observations; prints nothing without masks.
void PrintReport(const std::optional<MaskReport>& report, ReportLog* log);

// The region; prints nothing without one.
void PrintReport(const std::optional<Region>& region, ReportLog* log);

// Counts of a mesh.
void PrintTopology(const MeshReport& mesh, ReportLog* log);

// The meshing.
void PrintReport(const ManifoldMeshingReport& report, ReportLog* log);

// The size of a pixel on the mesh, scene units: the scale for distances in
// options.
void PrintFootprint(double footprint, ReportLog* log);

// Trimming and closing of holes; prints nothing if nothing was done.
void PrintReport(const BorderReport& report, ReportLog* log);

// Name of the image size of a level: "full size", "1/2 size".
std::string LevelName(int level);

// Splits the iterations by level and number of pairs. Energies are comparable
// only within a stage.
std::vector<std::vector<RefinementStep>> SplitIntoStages(
    const std::vector<RefinementStep>& steps);

// Name of the stage of a step: "1/2 size, final, 6 pairs".
std::string StageName(const RefinementStep& step);

// Text on a stage, for the screen and the page.
struct StageText {
  std::string name;
  std::string iterations;
  std::string faces;
  std::string energy[2];     // before and after
  std::string mean_zncc[2];  // before and after
};

std::vector<StageText> DescribeStages(const std::vector<RefinementStep>& steps);

// One iteration in one line.
std::string Describe(const RefinementStep& step);

// A refinement of the cameras in one line.
std::string Describe(const CameraRefinementReport& report);

// The iterations as CSV, with a header row.
std::string StepsCsv(const std::vector<RefinementStep>& steps);

// A plot of the mean ZNCC by iteration, with a panel and a scale for each
// stage: an SVG element for HTML.
std::string StepsFigure(const std::vector<RefinementStep>& steps);

// Prints the input of the refinement.
void PrintReport(const RefinementInput& input, ReportLog* log);

// Prints its result.
void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 ReportLog* log);

// Prints how well the images are aligned, and how far the camera of each moved,
// with warnings of those that moved far, did not converge, or could not be
// refined.
void PrintReport(const CameraAlignment& alignment,
                 const std::vector<View>& views, ReportLog* log);

// Prints tables of the figures.
void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, ReportLog* log);

// The figures as a JSON object, in scene units; null if there is none.
std::string EvaluationJson(const EvaluatorOptions& options,
                           const MeshEvaluation& evaluation);

}  // namespace colmap_ext
