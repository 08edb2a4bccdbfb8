#pragma once

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/evaluation_options.h"

namespace colmap_ext {

// Adds them to those of a command.
// \param evaluator  must outlive the parsing by the manager.
void AddEvaluatorOptions(CommandOptions* manager, EvaluatorOptions* evaluator);

}  // namespace colmap_ext
