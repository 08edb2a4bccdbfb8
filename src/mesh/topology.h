#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The combinatorial properties of a mesh. Vertices are equal if their indices
// are; positions do not matter.
struct MeshReport {
  size_t num_vertices = 0;
  size_t num_facets = 0;
  size_t num_edges = 0;
  size_t num_components = 0;    // of facets connected through edges
  size_t num_border_edges = 0;  // with one facet
  size_t num_border_loops = 0;  // closed chains of border edges
  int64_t euler = 0;            // V - E + F
  int64_t genus = 0;            // sum over the components; means something
                                // for manifold meshes only

  // Defects; all zero for a manifold mesh.
  size_t num_non_finite_vertices = 0;
  size_t num_unreferenced_vertices = 0;
  size_t num_invalid_facets = 0;      // with an index out of range
  size_t num_degenerate_facets = 0;   // that repeat a vertex
  size_t num_duplicate_facets = 0;    // of the same three vertices as another
  size_t num_non_manifold_edges = 0;  // with more than two facets
  size_t num_misoriented_edges = 0;   // run twice in the same direction
  size_t num_singular_vertices = 0;   // with more than one fan of facets

  // Every edge has one or two facets that run it in opposite directions, every
  // vertex one fan, closed or open; nothing is degenerate, repeated,
  // unreferenced or not finite.
  bool IsManifold() const { return Defects().empty(); }

  // The defects that there are, in words: "3 singular vertices, 1 ..."; empty
  // for a manifold mesh.
  std::string Defects() const;
};

// Accepts any mesh: what is wrong with it is reported.
MeshReport Analyze(const TriangleMesh& mesh);

}  // namespace colmap_ext
