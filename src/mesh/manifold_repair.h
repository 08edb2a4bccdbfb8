#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct ManifoldRepair {
  TriangleMesh mesh;

  // [V] the old vertices that a new one came from, as FanSplit has them.
  std::vector<std::array<uint32_t, 2>> sources;

  // Facets that were dropped: they had a vertex that is not there or not
  // finite, repeated a vertex, or had the vertices of another facet.
  size_t num_invalid_facets = 0;
  size_t num_degenerate_facets = 0;
  size_t num_duplicate_facets = 0;

  size_t num_unused_vertices = 0;  // dropped
  size_t num_split_vertices = 0;   // copies made
  size_t num_midpoints = 0;
};

// Makes any mesh manifold: drops what is no facet, repeats one, or belongs to
// none, and splits the rest by SplitFans. Facets that run an edge in the same
// direction come apart there, as do more than two at one edge.
ManifoldRepair RepairManifold(const TriangleMesh& mesh);

}  // namespace colmap_ext
