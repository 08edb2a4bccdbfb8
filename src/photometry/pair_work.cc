#include "photometry/pair_work.h"

#include <algorithm>

namespace colmap_ext {

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
  std::vector<uint32_t> pairs;  // of the view
  std::vector<uint32_t> local(labels.pairs.size(), UINT32_MAX);
  for (uint32_t i = 0; i < labels.pairs.size(); ++i) {
    if (labels.pairs[i].first == view || labels.pairs[i].second == view) {
      local[i] = static_cast<uint32_t>(pairs.size());
      pairs.push_back(i);
    }
  }
  std::vector<std::vector<PixelRectangle>> tiles(labels.pairs.size());
  const int num_cols = (drawn.width + kTileSize - 1) / kTileSize;
  std::vector<PixelRectangle> band(pairs.size() * num_cols);
  for (int band_row = 0; band_row < drawn.height; band_row += kTileSize) {
    std::fill(band.begin(), band.end(), PixelRectangle());
    const int last_row = std::min(band_row + kTileSize, drawn.height) - 1;
    for (int row = band_row; row <= last_row; ++row) {
      for (int col = 0; col < drawn.width; ++col) {
        const uint32_t facet = drawn.facets[drawn.Index(row, col)];
        if (facet == kNoFacet) {
          continue;
        }
        for (const uint32_t label : labels.labels[facet]) {
          if (local[label] == UINT32_MAX) {
            continue;
          }
          PixelRectangle& tile =
              band[static_cast<size_t>(local[label]) * num_cols +
                   col / kTileSize];
          if (tile.last_row < tile.first_row) {
            tile = {row, row, col, col};
          }
          tile.last_row = row;
          tile.first_col = std::min(tile.first_col, col);
          tile.last_col = std::max(tile.last_col, col);
        }
      }
    }
    for (size_t i = 0; i < pairs.size(); ++i) {
      for (int k = 0; k < num_cols; ++k) {
        const PixelRectangle& tile = band[i * num_cols + k];
        if (tile.last_row >= tile.first_row) {
          tiles[pairs[i]].push_back(tile);
        }
      }
    }
  }
  return tiles;
}

}  // namespace colmap_ext
