#include "spatial/box_tree.h"

#include <algorithm>
#include <bit>

namespace colmap_ext {

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3f>& boxes)
    : num_leaves_(std::bit_ceil(std::max<size_t>(boxes.size(), 1))) {
  nodes_.resize(num_leaves_ + boxes.size());
  std::ranges::copy(boxes,
                    nodes_.begin() + static_cast<ptrdiff_t>(num_leaves_));
  nodes_.resize(2 * num_leaves_);
  for (size_t node = num_leaves_ - 1; node > 0; --node) {
    nodes_[node] = nodes_[2 * node].merged(nodes_[2 * node + 1]);
  }
}

}  // namespace colmap_ext
