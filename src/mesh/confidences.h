#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// How well points confirm each facet of a surface: [F] in [0, 1]
// (docs/method.md, section 3.7). The support of the facet's corners, relative
// to the pixels that it covers where it is seen best, is compared with what is
// usual on this surface: 0.95 is the usual, 0 no support. A facet that is
// spanned far between well-supported vertices has little for its size.
// Independent of the scale of the scene, of the images and of the weights.
// \param support [V] of the points that each vertex stands for, not
//        negative
// \param vertex_views [V] the views that see each vertex, < views.size()
std::vector<float> FacetConfidences(const TriangleMesh& mesh,
                                    const std::vector<float>& support,
                                    const Rows<uint32_t>& vertex_views,
                                    const std::vector<View>& views);

// The mean of the facets at each vertex, weighed by their angles there: [V]; 0
// of a vertex without facets.
// \param facet_confidences [F] in [0, 1]
// \pre facet indices are in range
std::vector<float> VertexConfidences(
    const TriangleMesh& mesh, const std::vector<float>& facet_confidences);

// What the facets at each vertex have, summed: [V].
// \param facets [F]
// \param value  of one of `facets`, a function or a member
template <typename Facets, typename Value>
std::vector<double> SumsAtVertices(const TriangleMesh& mesh,
                                   const Facets& facets, const Value& value) {
  std::vector<double> sums(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      sums[vertex] += std::invoke(value, facets[i]);
    }
  }
  return sums;
}

// The mean of the corners of each facet: [F].
// \param values [V]
// \pre facet indices are in range
std::vector<float> MeanOfCorners(const std::vector<Facet>& facets,
                                 const std::vector<float>& values);

}  // namespace colmap_ext
