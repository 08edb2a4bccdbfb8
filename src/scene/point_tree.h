#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Finds the nearest of many points: a k-d tree (Bentley 1975), split at the
// median of the longest side of what a node holds.
class PointTree {
 public:
  // \pre the points are finite, and fewer than 2^32
  explicit PointTree(std::span<const Eigen::Vector3f> points);

  // The points nearest to a place, up to `count` of them, the nearest first;
  // none that is farther than max_distance. Of points as far the lower index
  // comes first.
  std::vector<uint32_t> Nearest(const Eigen::Vector3f& place, size_t count,
                                float max_distance) const;

 private:
  struct Search;

  void Build(size_t begin, size_t end);
  void Visit(size_t begin, size_t end, Search* search) const;

  // A node is a range of these; its own point is the middle one, the halves
  // before and after that are its children.
  std::vector<std::pair<Eigen::Vector3f, uint32_t>> points_;  // with its index
  std::vector<uint8_t> axes_;  // of the node with that middle
};

}  // namespace colmap_ext
