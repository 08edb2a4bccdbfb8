#pragma once

#include <cstddef>

#include "remesh/anchored_mesh.h"

namespace colmap_ext {

// Splits edges at their middles, the longest first, as long as any is more than
// `max_ratio` times as long as is wanted.
// \return the number of edges split
size_t SplitLongEdges(const ReferenceSurface& reference, float max_ratio,
                      AnchoredMesh* mesh);

}  // namespace colmap_ext
