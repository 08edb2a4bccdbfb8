#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "raster/facet_id_buffer.h"

namespace colmap_ext {

// The facets that each pair refines, ascending: [L].
Rows<uint32_t> GroupByPair(const FacetLabels& labels);

// Pixels of a view that are labelled with a pair: the smallest rectangle around
// those in one square of kTileSize^2 pixels.
struct PixelRectangle {
  int first_row = 0, last_row = -1;
  int first_col = 0, last_col = -1;
};

inline constexpr int kTileSize = 48;  // px

// [L] the rectangles of the pixels of a view that show facets labelled with
// each pair: empty for pairs that the view is not of.
std::vector<std::vector<PixelRectangle>> FindTiles(const FacetIdBuffer& drawn,
                                                   uint32_t view,
                                                   const FacetLabels& labels);

}  // namespace colmap_ext
