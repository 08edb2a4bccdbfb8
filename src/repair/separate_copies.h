#pragma once

#include <cstddef>

#include "repair/guarded_mesh.h"

namespace colmap_ext {

// Moves vertices that share a position with others (copies, see SplitFans)
// apart where their facets intersect: each into its own fan, towards the mean
// of its neighbors, or to the other side, by the smallest step of 2^k roundings
// of its coordinates that leaves the fewest pairs. A step is at most a quarter
// of the way. Ends where the mesh's Work() exceeds max_work.
// \return the number of vertices that were moved
size_t SeparateCopies(GuardedMesh* mesh, size_t max_work);

}  // namespace colmap_ext
