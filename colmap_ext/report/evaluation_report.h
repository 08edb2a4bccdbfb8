#pragma once

#include <string>

#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/report/print_lines.h"
#include "evaluation/mesh_evaluation.h"

namespace colmap_ext {

// Prints tables of the figures.
void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, ReportLog* log);

// The figures as a JSON object, in scene units; null if there is none.
std::string EvaluationJson(const EvaluatorOptions& options,
                           const MeshEvaluation& evaluation);

}  // namespace colmap_ext
