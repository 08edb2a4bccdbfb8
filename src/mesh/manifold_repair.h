#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct ManifoldRepair {
  TriangleMesh mesh;

  // [V] the old vertices that a new one comes from, as in FanSplit.
  std::vector<std::array<uint32_t, 2>> sources;

  // Facets that were dropped.
  size_t num_invalid_facets = 0;     // a vertex is missing or not finite
  size_t num_degenerate_facets = 0;  // repeat a vertex
  size_t num_duplicate_facets = 0;   // have the vertices of another facet

  size_t num_unused_vertices = 0;  // dropped
  size_t num_split_vertices = 0;   // copies made
  size_t num_midpoints = 0;
};

// Makes any mesh manifold: drops facets that are invalid, degenerate or
// duplicates, then vertices without a facet, and splits the fans of the rest by
// SplitFans(). Where two facets run an edge in the same direction, or more than
// two share it, all of them come apart there.
ManifoldRepair RepairManifold(const TriangleMesh& mesh);

}  // namespace colmap_ext
