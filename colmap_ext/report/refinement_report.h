#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "colmap_ext/refinement/refinement_input.h"
#include "mesh/topology.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// How the images of a level are called: "full size", "1/2 size".
std::string LevelName(int level);

// The iterations of each level, the final ones by themselves: energies can be
// compared within these alone.
std::vector<std::vector<RefinementStep>> SplitIntoStages(
    const std::vector<RefinementStep>& steps);

// Of a stage that the step is of: "1/2 size, final".
std::string StageName(const RefinementStep& step);

// One iteration in one line.
std::string Describe(const RefinementStep& step);

// A refinement of the cameras in one line.
std::string Describe(const CameraRefinementReport& report);

// The iterations as a table, one a row below a row of names.
std::string StepsCsv(const std::vector<RefinementStep>& steps);

// A plot of the energy by iteration, SVG: a panel with a scale of its own for
// each stage.
std::string StepsPlot(const std::vector<RefinementStep>& steps);

// On the screen: what is going to be refined ...
void PrintReport(const RefinementInput& input, std::ostream& stream);

// ... and what came of it.
void PrintReport(const RefinementReport& report, const MeshReport& mesh,
                 std::ostream& stream);

// How well the images are aligned.
void PrintReport(const Misalignment& misalignment,
                 const std::vector<View>& views, std::ostream& stream);

// How far the cameras moved, image by image, with warnings of those that moved
// far, did not converge, or could not be moved.
void PrintReport(const CameraRefinementReport& report,
                 const std::vector<View>& views, std::ostream& stream);

}  // namespace colmap_ext
