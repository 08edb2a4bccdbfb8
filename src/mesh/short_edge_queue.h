#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace colmap_ext {

// Half-edges by the lengths of their edges in targets, of which it takes those
// below 1 alone. Lengths are told apart as far as they fall in different
// bins; in a bin the last one in comes out first.
class ShortEdgeQueue {
 public:
  static constexpr int kNumBins = 64;

  // \param length  targets
  // \return kNumBins for an edge that is not short, or has no length
  static int BinOf(double length) {
    return length >= 0 && length < 1 ? static_cast<int>(length * kNumBins)
                                     : kNumBins;
  }

  void Push(int bin, uint32_t half) {
    if (bin < kNumBins) {
      bins_[bin].push_back(half);
      first_ = std::min(first_, bin);
    }
  }

  // The bin and the half-edge; none is left where the bin is kNumBins.
  std::pair<int, uint32_t> Pop() {
    while (first_ < kNumBins && bins_[first_].empty()) {
      ++first_;
    }
    if (first_ == kNumBins) {
      return {kNumBins, UINT32_MAX};
    }
    const uint32_t half = bins_[first_].back();
    bins_[first_].pop_back();
    return {first_, half};
  }

 private:
  std::array<std::vector<uint32_t>, kNumBins> bins_;
  int first_ = kNumBins;  // none before it holds anything
};

}  // namespace colmap_ext
