#pragma once

#include <string>
#include <utility>
#include <vector>

#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/refinement/refinement_input.h"

namespace colmap_ext {

// All that the result of a refinement depends on, but the program itself and
// its backend: pairs of a name and a value in words. The options come first,
// then the files with their fingerprints: the mesh, the fused points, the
// sparse model, and the picture of each view in the views' order.
using RunIdentity = std::vector<std::pair<std::string, std::string>>;

// Reads all of the files once.
// \param input  as ReadRefinementInput() has read it.
RunIdentity IdentifyRun(const RefinerOptions& options,
                        const RefinementPaths& paths,
                        const RefinementInput& input);

}  // namespace colmap_ext
