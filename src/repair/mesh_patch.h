#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Some facets of a mesh as a mesh, in the order of the whole.
struct MeshPatch {
  TriangleMesh mesh;
  std::vector<uint32_t> vertices;  // [V] the whole's, ascending
  std::vector<uint32_t> facets;    // [F] the whole's, ascending
};

// \param is_chosen  [F of the whole] 1: it is of the patch
MeshPatch TakePatch(const TriangleMesh& mesh,
                    const std::vector<uint8_t>& is_chosen);

// Marks all facets at the vertices within some rings of edges around facets.
// Goes through all of the mesh once a ring, and needs no adjacency.
// \return [F] 1: it is one of these
std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<uint32_t>& facets,
                                int num_rings);

// Marks all facets whose boxes meet any of the given ones, too.
void MarkWithin(const TriangleMesh& mesh,
                const std::vector<Eigen::AlignedBox3f>& boxes,
                std::vector<uint8_t>* is_marked);

}  // namespace colmap_ext
