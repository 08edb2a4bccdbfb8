#include "photometry/pair_work.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <tuple>
#include <utility>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// \pre rows come in ascending order
void Extend(int row, int col, PixelBox* tile) {
  if (tile->IsEmpty()) {
    *tile = {row, row, col, col};
  }
  tile->last_row = row;
  tile->first_col = std::min(tile->first_col, col);
  tile->last_col = std::max(tile->last_col, col);
}

}  // namespace

Rows<uint32_t> GroupByDirection(const FacetLabels& labels) {
  return GroupInRows<uint32_t>(2 * labels.pairs.size(), [&](const auto& add) {
    for (uint32_t facet = 0; facet < labels.NumFacets(); ++facet) {
      labels.ForEachDirection(
          facet, [&](uint32_t direction) { add(direction, facet); });
    }
  });
}

bool AreGroupsOf(const FacetLabels& labels, const Rows<uint32_t>& facets) {
  bool are_same = facets.size() == 2 * labels.pairs.size();
  size_t num_found = 0;
  // Where the next facet of each direction is to be found.
  std::vector<uint64_t> places = facets.offsets;
  for (uint32_t facet = 0; are_same && facet < labels.NumFacets(); ++facet) {
    labels.ForEachDirection(facet, [&](uint32_t direction) {
      uint64_t& place = places[direction];
      are_same = are_same && place < facets.offsets[direction + 1] &&
                 facets.values[place++] == facet;
      ++num_found;
    });
  }
  return are_same && num_found == facets.values.size();
}

Rows<uint32_t> DirectionsOfViews(const std::vector<ViewPair>& pairs,
                                 size_t num_views) {
  return GroupInRows<uint32_t>(num_views, [&](const auto& add) {
    for (uint32_t i = 0; i < pairs.size(); ++i) {
      add(pairs[i].first, 2 * i);
      add(pairs[i].second, 2 * i + 1);
    }
  });
}

void FacetPlaces::Set(std::span<const uint32_t> facets) {
  for (uint32_t k = 0; k < facets.size(); ++k) {
    Word& word = words_[facets[k] / 64];
    if (word.bits == 0) {
      word.num_before = k;
    }
    word.bits |= uint64_t{1} << facets[k] % 64;
  }
}

void FacetPlaces::Clear(std::span<const uint32_t> facets) {
  for (const uint32_t facet : facets) {
    words_[facet / 64].bits = 0;
  }
}

std::vector<std::vector<PixelBox>> FindTiles(
    const FacetIdBuffer& drawn, std::span<const uint32_t> directions,
    const FacetLabels& labels) {
  const size_t num_cols = (drawn.width + kTileSize - 1) / kTileSize;
  std::vector<uint32_t> places(2 * labels.pairs.size(), kNone);
  for (uint32_t k = 0; k < directions.size(); ++k) {
    places[directions[k]] = k;
  }
  // [directions][num_cols] the tiles of a row of squares.
  std::vector<std::vector<PixelBox>> squares(directions.size(),
                                             std::vector<PixelBox>(num_cols));
  std::vector<std::vector<PixelBox>> tiles(squares.size());
  for (int row = 0; row < drawn.height; ++row) {
    for (int col = 0; col < drawn.width; ++col) {
      const uint32_t facet = drawn.facets[drawn.Index(row, col)];
      if (facet == kNone) {
        continue;
      }
      labels.ForEachDirection(facet, [&](uint32_t direction) {
        if (places[direction] != kNone) {
          Extend(row, col, &squares[places[direction]][col / kTileSize]);
        }
      });
    }
    if ((row + 1) % kTileSize == 0 || row + 1 == drawn.height) {
      for (size_t k = 0; k < squares.size(); ++k) {
        for (PixelBox& tile : squares[k]) {
          if (!tile.IsEmpty()) {
            tiles[k].push_back(std::exchange(tile, {}));
          }
        }
      }
    }
  }
  return tiles;
}

std::vector<uint32_t> OrderByPartners(const Rows<uint32_t>& partners) {
  // A choice: about what 4 GB keep of 20 megapixels.
  constexpr size_t kMaxRecent = 16;
  std::deque<uint32_t> recent;  // the last used last
  std::vector<uint8_t> is_recent(partners.size(), 0);
  const auto use = [&](uint32_t view) {
    std::erase(recent, view);
    recent.push_back(view);
    is_recent[view] = 1;
    if (recent.size() > kMaxRecent) {
      is_recent[recent.front()] = 0;
      recent.pop_front();
    }
  };
  // The least is next. A view without any recent picture waits.
  const auto rank = [&](uint32_t view) {
    size_t num_recent = is_recent[view];
    for (const uint32_t partner : partners[view]) {
      num_recent += is_recent[partner];
    }
    return std::tuple(num_recent == 0, 1 + partners[view].size() - num_recent,
                      view);
  };
  std::vector<uint32_t> left = Iota(partners.size());
  std::vector<uint32_t> order;
  while (!left.empty()) {
    const auto next = std::ranges::min_element(left, {}, rank);
    order.push_back(*next);
    use(*next);
    std::ranges::for_each(partners[*next], use);
    left.erase(next);
  }
  return order;
}

std::vector<TiledDirection> FindDirections(const VisibilityBuffers& buffers,
                                           const FacetLabels& labels) {
  const auto of_views = DirectionsOfViews(labels.pairs, buffers.Views().size());
  std::vector<std::vector<TiledDirection>> by_view(of_views.size());
  tbb::parallel_for(size_t{0}, by_view.size(), [&](size_t view) {
    if (of_views[view].empty()) {
      return;
    }
    const auto tiles = FindTiles(*buffers.Get(view), of_views[view], labels);
    const auto i = static_cast<uint32_t>(view);
    for (size_t k = 0; k < tiles.size(); ++k) {
      const uint32_t direction = of_views[view][k];
      const auto [first, second] = labels.pairs[direction / 2];
      for (size_t begin = 0; begin < tiles[k].size(); begin += kMaxTiles) {
        const auto part = std::span(tiles[k]).subspan(begin);
        by_view[view].push_back(
            {direction,
             i,
             first == i ? second : first,
             {part.begin(), part.begin() + std::min(kMaxTiles, part.size())}});
      }
    }
  });
  Rows<uint32_t> partners;
  for (const std::vector<TiledDirection>& row : by_view) {
    std::vector<uint32_t> js;
    std::ranges::transform(row, std::back_inserter(js), &TiledDirection::j);
    SortUnique(&js);
    partners.AddRow(js);
  }
  std::vector<TiledDirection> directions;
  for (const uint32_t view : OrderByPartners(partners)) {
    std::ranges::move(by_view[view], std::back_inserter(directions));
  }
  return directions;
}

}  // namespace colmap_ext
