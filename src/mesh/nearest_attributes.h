#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// Returns colours and views for a mesh without .vis that was made from the
// points: the colour of the nearest point, however far, and the views of the
// four nearest within three mean edge lengths of the vertex. A vertex far from
// all points gets no views. No colours if the points have none.
//
// \pre there are points, all finite; facet indices are in range, vertices are
//      finite
VertexAttributes NearestAttributes(const TriangleMesh& mesh,
                                   const PointCloud& points);

}  // namespace colmap_ext
