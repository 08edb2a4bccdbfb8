#pragma once

#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/report/print_report.h"

namespace colmap_ext {

// facetwise_refiner with a plan: refines one of its tiles or, without a tile,
// plans how they are refined.
// \throw FileError for whatever is missing, damaged or does not fit together;
//        Interruption if a signal ended it.
void RunTiledRefinement(const RefinerOptions& options, Console* console);

}  // namespace colmap_ext
