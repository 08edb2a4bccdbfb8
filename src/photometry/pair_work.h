#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "raster/facet_id_buffer.h"
#include "raster/mesh_drawings.h"

namespace colmap_ext {

// [L] the facets that each pair refines, ascending.
Rows<uint32_t> GroupByPair(const FacetLabels& labels);

// A rectangle of pixels, both ends included.
struct PixelRectangle {
  int first_row = 0, last_row = -1;
  int first_col = 0, last_col = -1;

  bool IsEmpty() const { return last_row < first_row; }
};

// px. A choice: the scratch of a square with its margins, some 25 planes of
// floats, is 0.3 MB. Results depend on it by rounding only.
inline constexpr int kTileSize = 48;

// [L] the pixels of a view that show facets labelled with each pair: in each
// square of kTileSize^2 pixels that has any, the smallest rectangle around
// them, row by row. Empty for pairs that the view is not of.
std::vector<std::vector<PixelRectangle>> FindTiles(const FacetIdBuffer& drawn,
                                                   uint32_t view,
                                                   const FacetLabels& labels);

// A direction of a pair, i <- j, and the tiles of image i where it is compared.
struct TiledDirection {
  uint32_t pair = 0;
  uint32_t i = 0;
  uint32_t j = 0;
  std::vector<PixelRectangle> tiles;  // at least one
};

// The directions of all pairs that some pixel shows facets of, by their view i,
// so that few views are in use at a time.
std::vector<TiledDirection> FindDirections(const MeshDrawings& drawings,
                                           const FacetLabels& labels);

}  // namespace colmap_ext
