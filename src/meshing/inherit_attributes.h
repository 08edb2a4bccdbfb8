#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/index_limit.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// Colours and views of a mesh's vertices from the fused points that they come
// from: the mean colour of two points, and the views of either. A vertex that
// comes from none inherits them from its neighbors: their mean colour, and the
// views that at least half of them have. Neighbors that have none yet do not
// count; vertices far from all points inherit in later rounds. Without colours
// in the cloud there are none.
// \param points [V] two points of each vertex, which may be the same, or
//        kNone; the cloud's indices
VertexAttributes InheritAttributes(
    const TriangleMesh& mesh, const PointCloud& cloud,
    const std::vector<std::array<uint32_t, 2>>& points);

}  // namespace colmap_ext
