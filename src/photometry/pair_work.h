#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"

namespace colmap_ext {

// [2 L] the facets that are compared in each direction, ascending.
Rows<uint32_t> GroupByDirection(const FacetLabels& labels);

// Whether these are the rows of GroupByDirection(), which it does not build.
bool IsGroupedByDirection(const FacetLabels& labels,
                          const Rows<uint32_t>& facets);

// A rectangle of pixels, both ends included.
struct PixelRectangle {
  int first_row = 0, last_row = -1;
  int first_col = 0, last_col = -1;

  bool IsEmpty() const { return last_row < first_row; }
};

// px. A choice: the scratch of a square with its margins, some 25 planes of
// floats, is 0.3 MB. Results depend on it by rounding only.
inline constexpr int kTileSize = 48;

// [2 L] the pixels of a view that show facets compared there in each direction:
// in each square of kTileSize^2 pixels that has any, the smallest rectangle
// around them, row by row. Empty for directions of other views.
std::vector<std::vector<PixelRectangle>> FindTiles(const FacetIdBuffer& drawn,
                                                   uint32_t view,
                                                   const FacetLabels& labels);

// A direction of a pair, i <- j, and the tiles of image i where it is compared.
struct TiledDirection {
  uint32_t direction = 0;  // its index, see Directions
  uint32_t i = 0;
  uint32_t j = 0;
  std::vector<PixelRectangle> tiles;  // at least one
};

// The directions that some pixel shows facets of, by their view i, so that few
// views are in use at a time: as the views come, or, where they are more than
// would fit into 4 GB, by OrderByPartners().
std::vector<TiledDirection> FindDirections(const VisibilityBuffers& buffers,
                                           const FacetLabels& labels);

}  // namespace colmap_ext
