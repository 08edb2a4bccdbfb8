#pragma once

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"

namespace colmap_ext {

// Remeshes a surface with facets of the size that those in each neighborhood
// have on average: their shapes become even, their number stays about the same.
// \param attributes [V] see CarryAttributes().
// \pre the mesh is manifold, its vertices are finite
void RemeshEvenly(TriangleMesh* mesh, VertexAttributes* attributes);

}  // namespace colmap_ext
