#pragma once

#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// How well points bear out each vertex of a surface that was not made from them
// one by one: [V] in [0, 1] (docs/method.md, section 7.6). Each point supports
// the facet next to it that faces the views that see it, if it is not farther
// than a few pixels; FacetConfidences() then compares support and size.
// \param vertex_views [V] the views that see each vertex, < views.size()
// \param points  finite; their views are < views.size()
// \pre facet indices are in range, the vertices are finite
std::vector<float> PointConfidences(const TriangleMesh& mesh,
                                    const Rows<uint32_t>& vertex_views,
                                    const PointCloud& points,
                                    const std::vector<View>& views);

}  // namespace colmap_ext
