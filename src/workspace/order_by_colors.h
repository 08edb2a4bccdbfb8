#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "workspace/image_order.h"

namespace colmap_ext {

// Finds the order in which a .vis counts the images by the colours of the
// points: a point's colour is nearest to the pixels that it projects to in the
// right images. Reads a handful of the images in which the orders differ, and
// compares some points of each.
//
// \return the index of the order that is clearly better than every other;
//         nothing if there is none, or no colours or pictures to compare.
std::optional<size_t> FindOrderByColors(
    const OrderQuestion& question, const std::vector<VerifiedOrder>& orders);

// \param is_better  takes two indices.
// \return the index that is better than all others; nothing if there is none.
template <typename IsBetter>
std::optional<size_t> FindBest(size_t count, const IsBetter& is_better) {
  for (size_t i = 0; i < count; ++i) {
    size_t j = 0;
    while (j < count && (i == j || is_better(i, j))) {
      ++j;
    }
    if (j == count) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace colmap_ext
