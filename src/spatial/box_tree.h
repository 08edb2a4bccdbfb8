#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace colmap_ext {

// A binary tree over a list of boxes, whose neighbors in the list are near each
// other: each node has the box around a range of the list.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Eigen::AlignedBox3f>& boxes)
      : num_leaves_(std::bit_ceil(std::max<size_t>(boxes.size(), 1))),
        nodes_(2 * num_leaves_) {
    std::ranges::copy(boxes,
                      nodes_.begin() + static_cast<ptrdiff_t>(num_leaves_));
    for (size_t node = num_leaves_ - 1; node > 0; --node) {
      nodes_[node] = nodes_[2 * node].merged(nodes_[2 * node + 1]);
    }
  }

  // Calls visit(i) for the boxes that may_touch(box) holds for, ascending,
  // until it returns true. may_touch has to hold for what is around such a box.
  // \return whether a call did
  template <typename MayTouch, typename Visit>
  bool Search(const MayTouch& may_touch, const Visit& visit) const {
    std::vector<size_t> stack(1, 1);
    while (!stack.empty()) {
      const size_t node = stack.back();
      stack.pop_back();
      if (node >= nodes_.size() || nodes_[node].isEmpty() ||
          !may_touch(nodes_[node])) {
        continue;
      }
      if (node < num_leaves_) {
        stack.push_back(2 * node + 1);
        stack.push_back(2 * node);
      } else if (visit(static_cast<uint32_t>(node - num_leaves_))) {
        return true;
      }
    }
    return false;
  }

  // Whether predicate(box) holds for any box; it has to hold for what is around
  // such a box.
  template <typename Predicate>
  bool AnyOf(const Predicate& predicate) const {
    return Search(predicate, [](uint32_t /*i*/) { return true; });
  }

 private:
  size_t num_leaves_ = 1;  // a power of two
  // Node i has the children 2 i and 2 i + 1; the first leaf is num_leaves_.
  std::vector<Eigen::AlignedBox3f> nodes_;
};

}  // namespace colmap_ext
