#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// Colours and views of the vertices of a mesh that was made from the points,
// but does not say how: the colour of the nearest point, however far, and the
// views of the nearest four that lie within three times the mean length of the
// vertex's edges. A vertex far from all points gets no views.
//
// \pre points.size() > 0, facet indices are in range
VertexAttributes NearestAttributes(const TriangleMesh& mesh,
                                   const PointCloud& points);

}  // namespace colmap_ext
