#pragma once

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/meshing_options.h"

namespace colmap_ext {

// Adds them to those of a command, with COLMAP's names where the meaning is
// COLMAP's.
// \param mesher  must outlive the parsing by the manager.
void AddMesherOptions(CommandOptions* manager, MesherOptions* mesher);

// Those that say how the mesh is made, DelaunayManifoldMeshing.*, alone.
void AddMeshingOptions(CommandOptions* manager, MesherOptions* mesher);

}  // namespace colmap_ext
