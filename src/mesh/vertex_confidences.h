#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The mean of the facets at each vertex, weighed by their angles there: [V]; 0
// of a vertex without facets.
// \param facet_confidences [F] in [0, 1]
// \pre facet indices are in range
std::vector<float> VertexConfidences(
    const TriangleMesh& mesh, const std::vector<float>& facet_confidences);

// The mean of the corners of each facet: [F].
// \param vertex_confidences [V] in [0, 1]
// \pre facet indices are in range
std::vector<float> MeanOfCorners(const std::vector<Facet>& facets,
                                 const std::vector<float>& vertex_confidences);

}  // namespace colmap_ext
