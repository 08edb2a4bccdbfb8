#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// The support of each vertex of a tetrahedralization, the summed weights of the
// points that it stands for: [num_vertices].
// \param point_vertices [P] the vertex of each point, < num_vertices
// \param point_weights [P] not negative
std::vector<float> SupportOfVertices(
    size_t num_vertices, const std::vector<uint32_t>& point_vertices,
    const std::vector<float>& point_weights);

// The same for the vertices of a surface: [V] the mean of two supports.
// \param sources [V] two vertices each, as in FanSplit; those from
//        supports.size() on have none
std::vector<float> SupportOfSurface(
    const std::vector<float>& supports,
    const std::vector<std::array<uint32_t, 2>>& sources);

// How well points bear out each facet of a surface: [F] in [0, 1]
// (docs/method.md, section 3.6). The support of the facet's corners, relative
// to the pixels that it covers where it is seen best, is compared with what is
// usual on this surface: 0.95 is the usual, 0 no support. A facet that is
// spanned far between well-supported vertices has little for its size.
// Independent of the scale of the scene, of the images and of the weights.
// \param support [V] see SupportOfSurface()
// \param vertex_views [V] the views that see each vertex, < views.size()
std::vector<float> FacetConfidences(const TriangleMesh& mesh,
                                    const std::vector<float>& support,
                                    const Rows<uint32_t>& vertex_views,
                                    const std::vector<View>& views);

}  // namespace colmap_ext
