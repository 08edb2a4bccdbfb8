#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace colmap_ext {

// Two views that are compared, first < second.
struct ViewPair {
  uint32_t first = 0;
  uint32_t second = 0;

  bool operator==(const ViewPair&) const = default;
};

// By which pairs of views each facet is refined: the labels of the paper's
// Markov random field, one or several a facet, or none.
struct FacetLabels {
  std::vector<ViewPair> pairs;       // [L], ascending
  std::vector<uint64_t> offsets{0};  // [F + 1], into labels
  std::vector<uint32_t> labels;      // index into pairs, the best first, no
                                     // repeats in a row

  size_t NumFacets() const { return offsets.size() - 1; }

  std::span<const uint32_t> Labels(size_t facet) const {
    return {labels.data() + offsets[facet], labels.data() + offsets[facet + 1]};
  }

  // The first `count` of each facet.
  FacetLabels First(size_t count) const {
    FacetLabels first;
    first.pairs = pairs;
    for (size_t i = 0; i < NumFacets(); ++i) {
      const auto row = Labels(i);
      first.labels.insert(first.labels.end(), row.begin(),
                          row.begin() + std::min(row.size(), count));
      first.offsets.push_back(first.labels.size());
    }
    return first;
  }
};

}  // namespace colmap_ext
