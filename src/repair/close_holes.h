#pragma once

#include <cstddef>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"

namespace colmap_ext {

inline constexpr int kAllLoops = -1;

// What the closing of holes did.
struct HoleReport {
  size_t num_loops = 0;         // border loops that were to be closed
  size_t num_closed = 0;        // of them
  size_t num_facets = 0;        // new
  size_t num_vertices = 0;      // new
  size_t num_intersecting = 0;  // closed by facets that intersect others

  // Loops that stay, since their facets would make the mesh non-manifold.
  size_t NumLeft() const { return num_loops - num_closed; }
};

struct ClosedMesh {
  // The old vertices and facets as they were, then the new ones. Manifold.
  TriangleMesh mesh;
  VertexAttributes attributes;  // [V]
  HoleReport report;
};

// Closes the holes of a mesh (docs/method.md, section 3.8): border loops of up
// to max_edges edges. A loop is filled by small facets bent as the surface
// around it, or else, where these would intersect others or not be manifold, by
// flatter ones. New vertices have the confidence 0 if the old ones have any, no
// views, and colours by the inverse squared distances from the vertices of the
// loop.
// \param max_edges  0: none, kAllLoops: all
// \pre the mesh is manifold
ClosedMesh CloseHoles(int max_edges, TriangleMesh mesh,
                      VertexAttributes attributes);

}  // namespace colmap_ext
