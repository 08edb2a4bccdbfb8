#pragma once

#include <filesystem>

#include "refine/facetwise_refinement.h"
#include "scene/progress.h"

namespace colmap_ext {

// The refined surface of a plan, all of whose tiles are refined: their patches
// put together, borders and self-intersections as RefineFacetwise() leaves
// them.
// \throw FileError as RefineTile(), and where patches do not fit together
RefinedMesh MergeRefined(const std::filesystem::path& folder,
                         const Progress& progress);

}  // namespace colmap_ext
