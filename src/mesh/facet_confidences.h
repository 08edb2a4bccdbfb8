#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// How well points bear out each facet of a surface: [F] in [0, 1]
// (docs/method.md, section 3.6). The support of the facet's corners, relative
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

}  // namespace colmap_ext
