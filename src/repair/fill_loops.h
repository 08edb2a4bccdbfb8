#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A border loop: its vertices in the order in which the facets at the border
// run it. The first is not repeated.
using BorderLoop = std::vector<uint32_t>;

// How a loop is filled.
enum class FillingKind {
  kFair,     // facets as small as those around it, bent as the surface there
  kRefined,  // facets as small as those around it, near the flat ones
  kFlat,     // no new vertices
};

// What closes a loop.
struct LoopFilling {
  std::vector<Eigen::Vector3f> vertices;  // new ones
  std::vector<Facet> facets;  // of the mesh's vertices, and from there on of
                              // the new ones
};

// Returns what fills a loop, nothing where there is no way without an edge that
// the mesh around the loop has already. The facets have the smallest of the
// largest angles between them and the facets beside them [Liepa2003], new
// vertices are as dense as those of the loop, and fair ones minimize the change
// of curvature. By CGAL, with its errors turned into nothing.
// \throw std::bad_alloc if the memory does not suffice
// \param rings  MakeVertexRings() of the mesh
// \pre the mesh is manifold, its vertices are finite
std::optional<LoopFilling> FillLoop(FillingKind kind, const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const BorderLoop& loop);

}  // namespace colmap_ext
