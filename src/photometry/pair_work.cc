#include "photometry/pair_work.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {

namespace {

constexpr uint32_t kNotOfView = UINT32_MAX;

// The pairs that a view is of.
struct PairsOfView {
  std::vector<uint32_t> pairs;   // ascending
  std::vector<uint32_t> places;  // [L] in `pairs`, or kNotOfView
};

PairsOfView FindPairs(const std::vector<ViewPair>& pairs, uint32_t view) {
  PairsOfView of_view;
  of_view.places.assign(pairs.size(), kNotOfView);
  for (uint32_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].first == view || pairs[i].second == view) {
      of_view.places[i] = static_cast<uint32_t>(of_view.pairs.size());
      of_view.pairs.push_back(i);
    }
  }
  return of_view;
}

// \pre rows come in ascending order
void Extend(int row, int col, PixelRectangle* tile) {
  if (tile->IsEmpty()) {
    *tile = {row, row, col, col};
  }
  tile->last_row = row;
  tile->first_col = std::min(tile->first_col, col);
  tile->last_col = std::max(tile->last_col, col);
}

// The tiles of one row of squares.
struct TileBand {
  TileBand(size_t num_pairs, int width)
      : num_cols((width + kTileSize - 1) / kTileSize),
        tiles(num_pairs * num_cols) {}

  size_t num_cols;
  std::vector<PixelRectangle> tiles;  // [pairs of the view * num_cols]
};

void AddPixels(const FacetIdBuffer& drawn, int row, const FacetLabels& labels,
               const std::vector<uint32_t>& places, TileBand* band) {
  for (int col = 0; col < drawn.width; ++col) {
    const uint32_t facet = drawn.facets[drawn.Index(row, col)];
    if (facet == kNoFacet) {
      continue;
    }
    for (const uint32_t label : labels.labels[facet]) {
      if (places[label] != kNotOfView) {
        Extend(row, col,
               &band->tiles[places[label] * band->num_cols + col / kTileSize]);
      }
    }
  }
}

std::vector<TiledDirection> DirectionsTo(uint32_t view,
                                         const FacetIdBuffer& drawn,
                                         const FacetLabels& labels) {
  std::vector<TiledDirection> directions;
  std::vector<std::vector<PixelRectangle>> tiles =
      FindTiles(drawn, view, labels);
  for (uint32_t pair = 0; pair < tiles.size(); ++pair) {
    if (!tiles[pair].empty()) {
      const auto [first, second] = labels.pairs[pair];
      directions.push_back(
          {pair, view, first == view ? second : first, std::move(tiles[pair])});
    }
  }
  return directions;
}

}  // namespace

Rows<uint32_t> GroupByPair(const FacetLabels& labels) {
  Rows<uint32_t> pair_facets(labels.pairs.size());
  for (const uint32_t label : labels.labels.values) {
    ++pair_facets.offsets[label + 1];
  }
  for (size_t i = 0; i < labels.pairs.size(); ++i) {
    pair_facets.offsets[i + 1] += pair_facets.offsets[i];
  }
  std::vector<uint64_t> next(pair_facets.offsets.begin(),
                             pair_facets.offsets.end() - 1);
  pair_facets.values.resize(labels.labels.values.size());
  for (uint32_t facet = 0; facet < labels.NumFacets(); ++facet) {
    for (const uint32_t label : labels.labels[facet]) {
      pair_facets.values[next[label]++] = facet;
    }
  }
  return pair_facets;
}

std::vector<std::vector<PixelRectangle>> FindTiles(const FacetIdBuffer& drawn,
                                                   uint32_t view,
                                                   const FacetLabels& labels) {
  const PairsOfView of_view = FindPairs(labels.pairs, view);
  std::vector<std::vector<PixelRectangle>> tiles(labels.pairs.size());
  for (int first = 0; first < drawn.height; first += kTileSize) {
    TileBand band(of_view.pairs.size(), drawn.width);
    const int end = std::min(first + kTileSize, drawn.height);
    for (int row = first; row < end; ++row) {
      AddPixels(drawn, row, labels, of_view.places, &band);
    }
    for (size_t i = 0; i < band.tiles.size(); ++i) {
      if (!band.tiles[i].IsEmpty()) {
        tiles[of_view.pairs[i / band.num_cols]].push_back(band.tiles[i]);
      }
    }
  }
  return tiles;
}

std::vector<TiledDirection> FindDirections(const MeshDrawings& drawings,
                                           const FacetLabels& labels) {
  std::vector<uint8_t> is_used(drawings.Views().size(), 0);
  for (const ViewPair& pair : labels.pairs) {
    is_used[pair.first] = is_used[pair.second] = 1;
  }
  std::vector<std::vector<TiledDirection>> by_view(is_used.size());
  tbb::parallel_for(size_t{0}, by_view.size(), [&](size_t view) {
    if (is_used[view] != 0) {
      by_view[view] = DirectionsTo(static_cast<uint32_t>(view),
                                   *drawings.Get(view), labels);
    }
  });
  std::vector<TiledDirection> directions;
  for (std::vector<TiledDirection>& row : by_view) {
    std::move(row.begin(), row.end(), std::back_inserter(directions));
  }
  return directions;
}

}  // namespace colmap_ext
