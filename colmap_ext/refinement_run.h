#pragma once

#include <vector>

#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/report/html_page.h"
#include "colmap_ext/viewing/live_view.h"

namespace colmap_ext {

// Called before anything is read, so that an unwritable output fails early.
// \throw FileError if a file that the run writes can not be written.
void CheckOutputs(const RefinerOptions& options, const RefinementPaths& paths);

// One run of facetwise_refiner, from its files to its files.
// \param page_options  for the report's page.
// \param live  shows the run, or nullptr.
// \throw FileError for whatever is missing, damaged or does not fit together;
//        Interruption if a signal ended it.
void RunRefinement(const RefinerOptions& options, const RefinementPaths& paths,
                   const std::vector<PageOption>& page_options, LiveView* live);

// The same with a plan: refines one of its tiles or, without a tile, plans how
// they are refined.
void RunTiledRefinement(const RefinerOptions& options);

}  // namespace colmap_ext
