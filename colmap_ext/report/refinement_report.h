#pragma once

#include <string>
#include <vector>

#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/report/print_lines.h"
#include "mesh/topology.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// How the images of a level are called: "full size", "1/2 size".
std::string LevelName(int level);

// The iterations of each level, the final ones by themselves: energies can be
// compared within these alone.
std::vector<std::vector<RefinementStep>> SplitIntoStages(
    const std::vector<RefinementStep>& steps);

// Of a stage that the step is of: "1/2 size, final, 6 pairs".
std::string StageName(const RefinementStep& step);

// A stage in words, for the screen and the page.
struct StageText {
  std::string name;
  std::string iterations;
  std::string faces;
  std::string energy[2];     // before and after
  std::string mean_zncc[2];  // likewise
};

std::vector<StageText> DescribeStages(const std::vector<RefinementStep>& steps);

// One iteration in one line.
std::string Describe(const RefinementStep& step);

// A refinement of the cameras in one line.
std::string Describe(const CameraRefinementReport& report);

// The iterations as a table, one a row below a row of names.
std::string StepsCsv(const std::vector<RefinementStep>& steps);

enum class StepValue { kEnergy, kMeanZncc };

// A plot of a value by iteration: a panel with a scale of its own for each
// stage. An SVG element as it stands in HTML.
std::string StepsFigure(const std::vector<RefinementStep>& steps,
                        StepValue value);

// That of the energy as an SVG file.
std::string StepsPlot(const std::vector<RefinementStep>& steps);

// On the screen: what is going to be refined ...
void PrintReport(const RefinementInput& input, ReportLog* log);

// ... and what came of it.
void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 ReportLog* log);

// How well the images are aligned.
void PrintReport(const Misalignment& misalignment,
                 const std::vector<View>& views, ReportLog* log);

// How far the cameras moved, image by image, with warnings of those that moved
// far, did not converge, or could not be moved.
void PrintReport(const CameraRefinementReport& report,
                 const std::vector<View>& views, ReportLog* log);

}  // namespace colmap_ext
