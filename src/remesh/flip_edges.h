#pragma once

#include <cstddef>

#include "remesh/anchored_mesh.h"

namespace colmap_ext {

// Flips edges where this brings the numbers of edges at their four vertices
// closer to 6 (4 at a border), and keeps to the reference [Botsch2004].
// \return the number of flips
size_t FlipForValence(const ReferenceSurface& reference, AnchoredMesh* mesh);

// Flips edges where this makes the smallest angle of their two facets larger,
// and keeps to the reference.
// \param min_cosine  of that angle, in [0, 1]: edges of facets with better ones
//        stay.
// \return the number of flips
size_t FlipForAngles(const ReferenceSurface& reference, float min_cosine,
                     AnchoredMesh* mesh);

}  // namespace colmap_ext
