#pragma once

#include <string>
#include <vector>

#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/report/print_lines.h"
#include "mesh/topology.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

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

enum class StepValue { kEnergy, kMeanZncc };

// A plot of a value by iteration, with a panel and a scale for each stage: an
// SVG element for HTML.
std::string StepsFigure(const std::vector<RefinementStep>& steps,
                        StepValue value);

// The plot of the energy as an SVG file.
std::string StepsPlot(const std::vector<RefinementStep>& steps);

// Prints the input of the refinement.
void PrintReport(const RefinementInput& input, ReportLog* log);

// Prints its result.
void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 ReportLog* log);

// Prints how well the images are aligned.
void PrintReport(const Misalignment& misalignment,
                 const std::vector<View>& views, ReportLog* log);

// Prints how far the camera of each image moved, with warnings of those that
// moved far, did not converge, or could not be refined.
void PrintReport(const CameraRefinementReport& report,
                 const std::vector<View>& views, ReportLog* log);

}  // namespace colmap_ext
