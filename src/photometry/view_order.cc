#include "photometry/view_order.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <tuple>

namespace colmap_ext {

std::vector<uint32_t> OrderByPartners(const Rows<uint32_t>& partners) {
  // A choice: about what the default of max_memory_gb keeps of 20 megapixels.
  constexpr size_t kMaxRecent = 16;
  std::deque<uint32_t> recent;  // the last used last
  std::vector<uint8_t> is_recent(partners.size(), 0);
  const auto use = [&](uint32_t view) {
    std::erase(recent, view);
    recent.push_back(view);
    is_recent[view] = 1;
    if (recent.size() > kMaxRecent) {
      is_recent[recent.front()] = 0;
      recent.pop_front();
    }
  };
  // The least is next. A view without any recent picture waits.
  const auto rank = [&](uint32_t view) {
    size_t num_recent = is_recent[view];
    for (const uint32_t partner : partners[view]) {
      num_recent += is_recent[partner];
    }
    return std::tuple(num_recent == 0, 1 + partners[view].size() - num_recent,
                      view);
  };
  std::vector<uint32_t> left(partners.size());
  std::iota(left.begin(), left.end(), 0);
  std::vector<uint32_t> order;
  while (!left.empty()) {
    const auto next = std::ranges::min_element(left, {}, rank);
    order.push_back(*next);
    use(*next);
    std::ranges::for_each(partners[*next], use);
    left.erase(next);
  }
  return order;
}

}  // namespace colmap_ext
