#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// [V] not 0: the vertex is fixed: it is neither moved nor removed, and edges
// between two fixed vertices are kept. Vertices beyond the array are free;
// empty: all are.
using FixedVertices = std::vector<uint8_t>;

inline bool IsFixed(const FixedVertices& fixed, uint32_t vertex) {
  return vertex < fixed.size() && fixed[vertex] != 0;
}

// Whether all corners of a facet, and with them the facet, are fixed.
inline bool IsFixed(const FixedVertices& fixed, const Facet& facet) {
  return IsFixed(fixed, facet[0]) && IsFixed(fixed, facet[1]) &&
         IsFixed(fixed, facet[2]);
}

// [V] input index of each fixed vertex, kNone of the others; empty where none
// is fixed.
using FixedSources = std::vector<uint32_t>;

// \param fixed  of a mesh of so many vertices, or empty
inline FixedSources SourcesOf(const FixedVertices& fixed, size_t num_vertices) {
  FixedSources sources;
  for (uint32_t i = 0; !fixed.empty() && i < num_vertices; ++i) {
    sources.push_back(IsFixed(fixed, i) ? i : kNone);
  }
  return sources;
}

inline FixedVertices FixedOf(const FixedSources& sources) {
  FixedVertices fixed;
  for (const uint32_t source : sources) {
    fixed.push_back(source != kNone ? 1 : 0);
  }
  return fixed;
}

// Where the vertices and facets of a mesh come from that was made from another.
struct Provenance {
  // [V] two old vertices: the ends of the edge that a new one lies on, or twice
  // the vertex that it is; kNone where it comes from none.
  std::vector<std::array<uint32_t, 2>> vertices;

  std::vector<uint32_t> facets;  // [F] the old facet that each is, or is a part
                                 // of; kNone where there is none. Empty:
                                 // not kept

  bool operator==(const Provenance&) const = default;
};

// Each vertex and facet of a mesh comes from itself.
Provenance IdentityOf(const TriangleMesh& mesh);

// Where a mesh comes from after two steps. A vertex on an edge comes from the
// first source of the edge's first end and the second source of its second.
// \pre the second step makes nothing from none
Provenance Compose(const Provenance& first, Provenance second);

// Drops the vertices that no facet uses.
// \return [V] the index that each of the others had, ascending
std::vector<uint32_t> DropUnusedVertices(TriangleMesh* mesh);

struct DerivedMesh {
  TriangleMesh mesh;
  Provenance from;

  bool operator==(const DerivedMesh&) const = default;
};

// Some facets of a mesh as a mesh, in the order of the whole.
struct MeshPart {
  TriangleMesh mesh;
  std::vector<uint32_t> vertices;  // [V] the whole's, ascending
  std::vector<uint32_t> facets;    // [F] the whole's, ascending
};

// \param facets  ascending
MeshPart TakePart(const TriangleMesh& mesh, std::vector<uint32_t> facets);

// Colours, views and confidences of the vertices of a mesh.
struct VertexAttributes {
  std::vector<Color> colors;  // [V] or empty
  Rows<uint32_t> views;       // [V] indices of the views that see each vertex,
                              // ascending
  std::vector<float> confidences{};  // [V] in [0, 1] or empty: how well the
                                     // surface there is known; 0 is unseen
};

// Appends the attributes of a vertex.
void AddAttributes(const VertexAttributes& from, size_t vertex,
                   VertexAttributes* to);

// Returns the attributes of new vertices, each the midpoint of two old ones or
// twice the same old one: mean colours, rounded up, the views of either, and
// mean confidences.
// \param sources [V] two old vertices each
// \pre sources are in range of the attributes
VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources);

// Returns colours and views for a mesh without .vis that was made from the
// points: the colour of the nearest point, however far, and the views of the
// four nearest within three mean edge lengths of the vertex. A vertex far from
// all points gets no views. No colours if the points have none.
//
// \pre there are points, all finite; facet indices are in range, vertices are
//      finite
VertexAttributes NearestAttributes(const TriangleMesh& mesh,
                                   const PointCloud& points);

// A triangle mesh with what its vertices have.
struct Surface {
  TriangleMesh mesh;
  VertexAttributes attributes;             // [V]
  std::vector<Eigen::Vector3f> origins{};  // [V] or empty: where on the input
                                           // surface each vertex comes from
  FixedSources fixed_sources{};            // [V] or empty

  // Takes a mesh that was made from this one. Its vertices get the attributes
  // of InterpolateAttributes() and the means of the origins of their sources;
  // those that come from two vertices are not fixed.
  // \pre all vertices come from some
  void Become(DerivedMesh derived);
};

}  // namespace colmap_ext
