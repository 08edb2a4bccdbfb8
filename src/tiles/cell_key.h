#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/mix_bits.h"

namespace colmap_ext {

// A cell by the plan's vertices at its corners, ascending; kInfiniteVertex is
// the last. A facet likewise.
using CellKey = std::array<uint32_t, 4>;
using FacetKey = std::array<uint32_t, 3>;

template <size_t kSize>
std::array<uint32_t, kSize> Sorted(std::array<uint32_t, kSize> ids) {
  std::ranges::sort(ids);
  return ids;
}

// For tables by key.
struct KeyHash {
  template <size_t kSize>
  size_t operator()(const std::array<uint32_t, kSize>& key) const {
    uint64_t hash = 0;
    for (const uint32_t id : key) {
      hash = MixBits(hash + kSplitMixStep + id);
    }
    return hash;
  }
};

}  // namespace colmap_ext
