#pragma once

#include <cstdint>
#include <vector>

#include "raster/facet_id_buffer.h"

namespace colmap_ext {

// [height * width] as a buffer has them, or kNone.
inline std::vector<uint32_t> ShownFacets(const FacetIdBuffer& drawn) {
  std::vector<uint32_t> shown;
  for (size_t i = 0; i < drawn.facets.size(); ++i) {
    shown.push_back(drawn.facets[i]);
  }
  return shown;
}

}  // namespace colmap_ext
