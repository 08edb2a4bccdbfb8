#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

inline constexpr uint32_t kNoFacet = UINT32_MAX;

// Which facet each pixel of a view shows at its centre, and how near.
struct FacetIdBuffer {
  int width = 0;                      // px
  int height = 0;                     // px
  std::vector<uint32_t> facets;       // [height * width] or kNoFacet
  std::vector<float> inverse_depths;  // [height * width], 1 / scene unit; 0
                                      // where there is no facet

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// Draws a mesh into a view, both sides of the facets; the nearest one wins, of
// equally near ones the first. As graphics cards do, vertices are moved to the
// nearest 1/256 of a pixel, so that no pixel falls between neighbors. Facets
// with a vertex behind the camera are not drawn.
FacetIdBuffer DrawFacets(const View& view, const TriangleMesh& mesh);

}  // namespace colmap_ext
