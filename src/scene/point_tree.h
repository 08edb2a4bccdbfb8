#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Finds the nearest of many points by a k-d tree [Bentley1975], nanoflann's.
// Searches may run in parallel.
class PointTree {
 public:
  // \param points  [P], any frame; not copied
  // \pre the points are finite, fewer than 2^32, and outlive the tree
  explicit PointTree(std::span<const Eigen::Vector3f> points);
  ~PointTree();

  // Returns the indices of the points nearest to a place, at most `count`, the
  // nearest first, none of them farther away than max_distance (units of the
  // points). Of points at the same distance the lower index comes first.
  // Points whose squared distance is no finite float are not found.
  std::vector<uint32_t> Nearest(const Eigen::Vector3f& place, size_t count,
                                float max_distance) const;

  // Returns the points that are nearer to a place than a distance, up to
  // rounding, in an order that depends on the points and the place alone.
  std::vector<uint32_t> Within(const Eigen::Vector3f& place,
                               float distance) const;

 private:
  struct Index;

  std::unique_ptr<const Index> index_;  // none without points
};

}  // namespace colmap_ext
