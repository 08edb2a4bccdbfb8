#include "photometry/view_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>

namespace colmap_ext {

namespace {

class ViewOrder {
 public:
  explicit ViewOrder(const Rows<uint32_t>& partners)
      : partners_(partners),
        users_(partners.size()),
        num_missing_(partners.size()),
        num_recent_(partners.size(), 0),
        is_recent_(partners.size(), 0) {
    for (uint32_t view = 0; view < partners.size(); ++view) {
      users_[view].push_back(view);
      for (const uint32_t partner : partners[view]) {
        users_[partner].push_back(view);
      }
      num_missing_[view] = static_cast<uint32_t>(1 + partners[view].size());
    }
  }

  std::vector<uint32_t> Run() {
    std::vector<uint32_t> left(partners_.size());
    for (uint32_t i = 0; i < left.size(); ++i) {
      left[i] = i;
    }
    std::vector<uint32_t> order;
    while (!left.empty()) {
      const auto next = std::min_element(
          left.begin(), left.end(),
          [this](uint32_t a, uint32_t b) { return Rank(a) < Rank(b); });
      order.push_back(*next);
      Use(*next);
      for (const uint32_t partner : partners_[*next]) {
        Use(partner);
      }
      left.erase(next);
    }
    return order;
  }

 private:
  // A choice: about what the default of max_memory_gb keeps of 20 megapixels.
  static constexpr size_t kMaxRecent = 16;

  // The least is next. A view that has nothing to do with the last ones waits.
  std::array<uint32_t, 3> Rank(uint32_t view) const {
    return {num_recent_[view] == 0 ? 1U : 0U, num_missing_[view], view};
  }

  void Use(uint32_t view) {
    if (is_recent_[view] != 0) {
      recent_.erase(std::find(recent_.begin(), recent_.end(), view));
    } else {
      SetRecent(view, true);
    }
    recent_.push_back(view);
    if (recent_.size() > kMaxRecent) {
      SetRecent(recent_.front(), false);
      recent_.pop_front();
    }
  }

  void SetRecent(uint32_t view, bool is_recent) {
    is_recent_[view] = is_recent ? 1 : 0;
    for (const uint32_t user : users_[view]) {
      num_missing_[user] += is_recent ? -1 : 1;
      num_recent_[user] += is_recent ? 1 : -1;
    }
  }

  const Rows<uint32_t>& partners_;
  std::vector<std::vector<uint32_t>> users_;  // [views] it, and whose partner
                                              // it is
  std::vector<uint32_t> num_missing_;         // [views] of it and its partners
  std::vector<uint32_t> num_recent_;          // [views] the others of these
  std::vector<uint8_t> is_recent_;            // [views]
  std::deque<uint32_t> recent_;               // the last used last
};

}  // namespace

std::vector<uint32_t> OrderByPartners(const Rows<uint32_t>& partners) {
  return ViewOrder(partners).Run();
}

}  // namespace colmap_ext
