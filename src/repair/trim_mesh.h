#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// What a trimming did.
struct TrimReport {
  size_t num_regions = 0;          // of facets that are not confident, dropped
  size_t num_facets = 0;           // in them
  size_t num_leftovers = 0;        // pieces dropped with them
  size_t num_leftover_facets = 0;  // in them
  size_t num_kept_facets = 0;      // not confident, but in small gaps
};

struct TrimmedMesh {
  TriangleMesh mesh;                             // manifold
  std::vector<std::array<uint32_t, 2>> sources;  // [V] twice the old vertex
  std::vector<uint32_t> facet_sources;           // [F] ascending
  TrimReport report;
};

// Drops the parts of low confidence from a surface (docs/method.md, section
// 3.7).
//
// Facets below min_confidence that are connected through edges are a region.
// A region is kept if it is only a gap in good surface: if it reaches no border
// of the mesh and is not larger than `num_rings` rings of confident facets
// around it. The other regions are dropped, and so are the pieces that they cut
// off and that consist of little but border: with no more vertices inside than
// at their border. This is repeated until nothing is dropped. The borders that
// this opens are smoothed along themselves; all other vertices stay where they
// are. Where nothing is dropped the mesh stays as it is, and trimming the
// result again with the same confidences drops nothing.
//
// \param min_confidence  0: drops nothing
// \param facet_confidences [F] in [0, 1]
// \param num_rings  positive; a mesh of small facets needs more rings.
// \pre the mesh is manifold
TrimmedMesh TrimMesh(double min_confidence, TriangleMesh mesh,
                     const std::vector<float>& facet_confidences,
                     int num_rings = 1);

}  // namespace colmap_ext
