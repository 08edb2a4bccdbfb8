#pragma once

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/viewer_options.h"

namespace colmap_ext {

// Adds them to those of a command.
// \param viewer  has to outlive the manager's parsing.
void AddViewerOptions(CommandOptions* manager, ViewerOptions* viewer);

}  // namespace colmap_ext
