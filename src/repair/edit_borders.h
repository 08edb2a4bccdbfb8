#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "repair/close_holes.h"
#include "repair/trim_mesh.h"

namespace colmap_ext {

struct BorderOptions {
  // Facets of less confidence are dropped, see TrimMesh(). In [0, 1]; 0 drops
  // none.
  double trim = 0;

  // Border loops of up to as many edges are closed, see CloseHoles(); 0 none,
  // kAllLoops all.
  int close_holes = 0;

  // Of facets around what is not confident, see TrimMesh(). Positive.
  int trim_rings = 1;

  // Where no facet is confident the mesh stays as it is.
  bool is_trim_optional = false;
};

struct BorderReport {
  TrimReport trim;
  HoleReport holes;
};

struct EditedMesh {
  TriangleMesh mesh;                     // manifold
  VertexAttributes attributes;           // [V]
  std::vector<uint32_t> vertex_sources;  // [V] the old vertex; new: kNone
  std::vector<uint32_t> facet_sources;   // [F] the old facet; new: kNone
  BorderReport report;
};

// Trims a mesh, then closes its holes.
// \param facet_confidences [F] in [0, 1]
// \pre the mesh is manifold, options in their ranges
// \throw std::invalid_argument if the trimming leaves nothing, unless it is
//        optional.
EditedMesh EditBorders(const BorderOptions& options, TriangleMesh mesh,
                       VertexAttributes attributes,
                       const std::vector<float>& facet_confidences);

}  // namespace colmap_ext
