#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/rows.h"
#include "labeling/facet_labels.h"
#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"

namespace colmap_ext {

// [2 L] the facets that are compared in each direction, ascending.
Rows<uint32_t> GroupByDirection(const FacetLabels& labels);

// The places of some facets of a mesh in a list of them: a bit a facet, and how
// many come before each 64. Each thread has one.
class FacetPlaces {
 public:
  explicit FacetPlaces(size_t num_facets) : words_(num_facets / 64 + 1) {}

  // \param facets  ascending.
  void Set(std::span<const uint32_t> facets);
  // \param facets  those that were set.
  void Clear(std::span<const uint32_t> facets);

  bool Has(uint32_t facet) const {
    return (words_[facet / 64].bits >> facet % 64 & 1) != 0;
  }
  // \pre Has(facet)
  uint32_t operator[](uint32_t facet) const {
    const Word& word = words_[facet / 64];
    const uint64_t before = word.bits & ((uint64_t{1} << facet % 64) - 1);
    return word.num_before + static_cast<uint32_t>(std::popcount(before));
  }

 private:
  struct Word {
    uint64_t bits = 0;
    uint32_t num_before = 0;
  };

  std::vector<Word> words_;
};

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
