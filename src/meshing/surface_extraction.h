#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The facets between matter and free space, vertices still those of the
// tetrahedralization.
struct ExtractedSurface {
  TriangleMesh mesh;  // all of the tetrahedralization's points, used or not
  // [3 F] the half-edge with which each forms one surface: of the two facets
  // that the matter between them connects around the edge. kNone at a
  // border, where the surface continues to the vertex at infinity.
  std::vector<uint32_t> partners;
};

// Facets are in the order of the cells in matter. Their normals (right-handed)
// point into free space. Facets at infinity are left out.
// \param is_free [C] labels of the cells, 1: free space, 0: matter
ExtractedSurface ExtractSurface(const Tetrahedralization& tetrahedra,
                                const std::vector<uint8_t>& is_free);

}  // namespace colmap_ext
