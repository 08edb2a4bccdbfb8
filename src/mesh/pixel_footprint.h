#pragma once

#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// What a pixel covers on a mesh, the median over its vertices and the views
// that see them: depth over focal length, scene units. 0 where no view sees a
// vertex.
// \param vertex_views [V] see VertexAttributes
double MedianFootprint(const TriangleMesh& mesh,
                       const Rows<uint32_t>& vertex_views,
                       const std::vector<View>& views);

}  // namespace colmap_ext
