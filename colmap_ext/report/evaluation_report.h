#pragma once

#include <string>

#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/report/print_lines.h"
#include "evaluation/mesh_evaluation.h"

namespace colmap_ext {

// For the user, on the screen: tables of the figures.
void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, ReportLog* log);

// For programs: the same as a JSON object, in scene units; what there is no
// figure for is null.
std::string EvaluationJson(const EvaluatorOptions& options,
                           const MeshEvaluation& evaluation);

}  // namespace colmap_ext
