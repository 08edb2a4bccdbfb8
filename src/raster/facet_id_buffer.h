#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "raster/facet_frames.h"
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
  std::vector<bool> is_facing;        // [F] the camera, enough to be compared

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// Draws a mesh into a view, both sides of the facets; the nearest one wins, of
// equally near ones the first. As graphics cards do, vertices are moved to the
// nearest 1/256 of a pixel, so that no pixel falls between neighbors. Facets
// with a vertex behind the camera are not drawn.
// \param min_cosine  between its normal and the ray to the camera a facet faces
//        the camera above this.
FacetIdBuffer DrawFacets(const View& view, const TriangleMesh& mesh,
                         double min_cosine);

// By how much the inverse depth of a facet's plane changes in a view, at most,
// from a pixel to one of the eight around it.
double PlaneSlope(const View& view, const FacetFrame& frame);

// Whether a view sees a point of a facet: the pixel shows the facet, or nothing
// nearer than its plane comes within two pixels around, and two pixels'
// footprints more.
// \param slope  PlaneSlope() of the facet.
// \param u, v, inverse_depth  of the point in the view, inside the image.
inline bool IsNearest(const View& view, const FacetIdBuffer& drawn,
                      uint32_t facet, double slope, double u, double v,
                      double inverse_depth) {
  const size_t pixel = drawn.Index(static_cast<int>(v), static_cast<int>(u));
  const double footprint = inverse_depth / std::min(view.fx, view.fy);
  return drawn.facets[pixel] == facet ||
         drawn.inverse_depths[pixel] <= inverse_depth + 2 * (slope + footprint);
}

}  // namespace colmap_ext
