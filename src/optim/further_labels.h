#pragma once

#include <cstdint>
#include <vector>

#include "optim/potts_mrf.h"

namespace colmap_ext {

// Several labels of each node, the chosen one first.
struct LabelSets {
  std::vector<uint64_t> offsets{0};  // [N + 1], into labels
  std::vector<uint32_t> labels;

  const uint32_t* Labels(uint32_t node) const {
    return labels.data() + offsets[node];
  }
};

// Adds to each node's choice the cheapest others of its labels, `count` in all
// where it has as many. As with the first label, those that neighbors have too
// are preferred: for each neighbor that has not got it, a label costs a third
// of the field's weight more. That is found in a few rounds, in each of which
// half of the nodes choose anew by what their neighbors have.
//
// \param choices  [N] see PottsSolution
// \pre count > 0
LabelSets AddFurtherLabels(const PottsProblem& problem,
                           const std::vector<uint32_t>& choices,
                           uint32_t count);

}  // namespace colmap_ext
