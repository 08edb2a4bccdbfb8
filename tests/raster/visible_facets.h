#pragma once

#include <cstdint>
#include <vector>

#include "raster/visibility_buffers.h"

namespace colmap_ext {

inline FacetVisibility VisibleFacets(const TriangleMesh& mesh,
                                     const std::vector<View>& views,
                                     double min_cosine = 0.1,
                                     double border = kVisibilityBorder) {
  return FindVisibleFacets(VisibilityBuffers(mesh, views, min_cosine, SIZE_MAX),
                           border);
}

}  // namespace colmap_ext
