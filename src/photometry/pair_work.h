#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/rows.h"
#include "labeling/view_pairs.h"
#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"

namespace colmap_ext {

// [2 L] the facets that are compared in each direction, ascending.
Rows<uint32_t> GroupByDirection(const FacetLabels& labels);

// Whether facets are those of GroupByDirection(), without making them again.
bool AreGroupsOf(const FacetLabels& labels, const Rows<uint32_t>& facets);

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

// px. A choice: the scratch of a square with its margins, some 25 planes of
// floats, is 0.3 MB. Results depend on it by rounding only.
inline constexpr int kTileSize = 48;

// [views] the directions in which each view is compared, ascending.
Rows<uint32_t> DirectionsOfViews(const std::vector<ViewPair>& pairs,
                                 size_t num_views);

// [directions] the pixels of a view that show facets compared in each of its
// directions: in each square of kTileSize^2 pixels that has any, the smallest
// rectangle around them, row by row.
// \param directions  of the view, ascending.
std::vector<std::vector<PixelBox>> FindTiles(
    const FacetIdBuffer& drawn, std::span<const uint32_t> directions,
    const FacetLabels& labels);

// An order of the views in which each one and most of its partners were used
// shortly before, as few of many views fit into memory at a time. Greedy: next
// is the view that lacks the fewest images, of itself and its partners, among
// the last 16 that were used; of equal ones the first. The order does not
// depend on the memory, and so sums in this order do not either.
// \param partners [views] of each view, without repeats.
// \return all views, each once.
std::vector<uint32_t> OrderByPartners(const Rows<uint32_t>& partners);

// Calls function(value) for all values of an order, in parallel. The calls
// begin in that order for any number of threads, so that calls that run at a
// time use the same few views.
template <typename T, typename Function>
void ForEachInOrder(const std::vector<T>& order, const Function& function) {
  std::atomic<size_t> next = 0;
  tbb::parallel_for(size_t{0}, order.size(),
                    [&](size_t) { function(order[next++]); });
}

// A direction of a pair, i <- j, and some of the tiles of image i where it is
// compared: parts of a direction are work for several threads.
struct TiledDirection {
  uint32_t direction = 0;  // its index, see Directions
  uint32_t i = 0;
  uint32_t j = 0;
  std::vector<PixelBox> tiles;  // 1 to kMaxTiles
};

// A choice: a part costs little beside its work, and few images still make
// enough parts for many threads. Results depend on it by rounding only.
inline constexpr size_t kMaxTiles = 256;

// The directions that some pixel shows facets of, by their view i in the order
// of OrderByPartners(), the parts of each one after the other.
std::vector<TiledDirection> FindDirections(const VisibilityBuffers& buffers,
                                           const FacetLabels& labels);

}  // namespace colmap_ext
