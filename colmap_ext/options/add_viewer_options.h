#pragma once

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/viewer_options.h"

namespace colmap_ext {

// Adds them to those of a command.
// \param viewer  must outlive the parsing by the manager.
void AddViewerOptions(CommandOptions* manager, ViewerOptions* viewer);

}  // namespace colmap_ext
