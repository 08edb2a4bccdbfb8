#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "optim/potts_mrf.h"

namespace colmap_ext {

// Several labels of each node, or none. [N]
using LabelSets = Rows<uint32_t>;

// The chosen label of each node, none where it has no choice.
// \param choices  [N] see PottsSolution
LabelSets ChosenLabels(const PottsProblem& problem,
                       const std::vector<uint32_t>& choices);

// Adds to each node's labels the cheapest others, `count` in all where it has
// as many. As with the first label, those that neighbors have too are
// preferred: for each neighbor that has not got it, a label costs a third of
// the field's weight more: a label that no neighbor has costs the weight. That
// is approached in a few rounds, in each of which half of the nodes choose
// again by what their neighbors have.
//
// \param given  labels that stay, and stay first; not more than `count` a node
// \return the labels of each node, `count` or all that it has
LabelSets AddFurtherLabels(const PottsProblem& problem, const LabelSets& given,
                           uint32_t count);

}  // namespace colmap_ext
