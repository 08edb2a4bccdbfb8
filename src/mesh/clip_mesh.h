#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/region.h"

namespace colmap_ext {

struct ClippedMesh {
  TriangleMesh mesh;

  // [V] the two old vertices that a new one comes from: the ends of the edge
  // that the region's border cuts there, or twice the vertex that it is.
  std::vector<std::array<uint32_t, 2>> sources;

  std::vector<uint32_t> facet_sources;  // [F] the old facet of each

  bool is_clipped = false;  // anything was cut off
};

// Cuts off what lies outside of a region. Facets across its border are cut
// along it: new vertices lie on the border, one an edge that is cut, so that
// the mesh stays as connected as it was. Vertices that float coordinates put a
// rounding beyond the border count as on it, so that a mesh that was clipped
// stays as it is. A vertex on the border may become singular: see SplitFans().
// Vertices that no facet uses any more are dropped; facets inside keep their
// order, parts of others come in their place.
// \pre facet indices are in range, vertices are finite
ClippedMesh ClipMesh(const Region& region, TriangleMesh mesh);

struct CutMesh {
  TriangleMesh mesh;
  VertexAttributes attributes;          // [V]
  std::vector<uint32_t> facet_sources;  // [F] the old facet; kNone where an
                                        // edge was split at its midpoint
};

// The same for a manifold mesh with attributes, which stays manifold.
// Attributes of new vertices are those of InterpolateAttributes().
CutMesh CutOff(const Region& region, TriangleMesh mesh,
               VertexAttributes attributes);

}  // namespace colmap_ext
