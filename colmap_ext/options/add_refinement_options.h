#pragma once

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/refinement_options.h"

namespace colmap_ext {

// Adds them to those of a command.
// \param refiner  must outlive the parsing by the manager.
void AddRefinerOptions(CommandOptions* manager, RefinerOptions* refiner);

// Those of them that decide what becomes of a mesh and its pictures.
void AddResultOptions(CommandOptions* manager, RefinerOptions* refiner);

}  // namespace colmap_ext
