#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

// The confidence of each vertex of a refined surface: [V] in [0, 1]
// (docs/method.md, section 7.6). With t the share of texture in the pixels that
// are compared on the facets at the vertex, sum of w / number of pixels, and Z
// their mean correlation, it is
//   (1 - t) before + t max(0, Z):
// what the images can not tell leaves the confidence as it was.
// \param before [V] without the images, in [0, 1]; empty: 0 everywhere
// \param terms  of the mesh
std::vector<float> RefinedConfidences(const TriangleMesh& mesh,
                                      const PhotometricTerms& terms,
                                      const PhotometricOptions& options,
                                      const std::vector<float>& before);

}  // namespace colmap_ext
