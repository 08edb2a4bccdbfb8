#pragma once

#include <cstdint>

#include "base/rows.h"
#include "raster/visibility_buffers.h"

namespace colmap_ext {

// [F] the views that show each facet, ascending.
using FacetVisibility = Rows<uint32_t>;

// A window of radius 2 around a pixel, and the pixel beyond it that bicubic
// sampling takes, lie within the image.
inline constexpr double kVisibilityBorder = 3;  // px

// Which views show the facets' centroids (docs/method.md, section 4.2): nothing
// is drawn in front of the centroid, the facet faces the camera, and the
// centroid is not at the image's border. Of a facet that is drawn by a part
// (FindClippedFacets) the middle of what lies within the border counts.
// \param border  how far the centroid has to keep from the image's border, px.
FacetVisibility FindVisibleFacets(const VisibilityBuffers& buffers,
                                  double border = kVisibilityBorder);

}  // namespace colmap_ext
