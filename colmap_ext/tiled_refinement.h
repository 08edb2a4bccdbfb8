#pragma once

#include "colmap_ext/options/refinement_options.h"

namespace colmap_ext {

// What facetwise_refiner does with a plan: refines one of its tiles or, without
// a tile, plans how they are refined.
// \throw FileError, Interruption as RunRefinement()
void RunTiledRefinement(const RefinerOptions& options);

}  // namespace colmap_ext
