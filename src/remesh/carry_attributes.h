#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "spatial/surface_point.h"

namespace colmap_ext {

// Returns the attributes of points on a mesh: colours between those of the
// facet's corners, rounded, and the views of any corner that has a part in it.
// \param attributes [V] of the mesh
// \param points [N]
VertexAttributes CarryAttributes(const TriangleMesh& mesh,
                                 const VertexAttributes& attributes,
                                 const std::vector<SurfacePoint>& points);

}  // namespace colmap_ext
