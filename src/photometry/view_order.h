#pragma once

#include <cstdint>
#include <vector>

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

}  // namespace colmap_ext
