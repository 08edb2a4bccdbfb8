#pragma once

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/options/evaluation_options.h"

namespace colmap_ext {

// Adds them to those of a command.
// \param evaluator  has to outlive the manager's parsing.
void AddEvaluatorOptions(colmap::OptionManager* manager,
                         EvaluatorOptions* evaluator);

}  // namespace colmap_ext
