#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/rows.h"

namespace colmap_ext {

// An order in which views are worked on one after the other, each together with
// its partners, so that most of these were in use shortly before: of many views
// few fit into memory at a time, whatever order they come in. Next is always
// the view that lacks the fewest pictures, its own and its partners', of the
// last 16 that were in use; of those alike the first. As it does not depend on
// how many fit, nor does what is summed up in this order.
// \param partners [views] of each view, without repeats.
// \return all views, each once.
std::vector<uint32_t> OrderByPartners(const Rows<uint32_t>& partners);

// Calls function(i) for all i of an order, in parallel. They begin in that
// order, however many threads there are, so that those at work at a time use
// the same few views.
template <typename Function>
void ForEachInOrder(const std::vector<uint32_t>& order,
                    const Function& function) {
  std::atomic<size_t> next = 0;
  tbb::parallel_for(size_t{0}, order.size(),
                    [&](size_t) { function(order[next++]); });
}

}  // namespace colmap_ext
