#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Finds the nearest of many points by a k-d tree [Bentley1975], which is built
// in parallel. Searches may run in parallel, too.
class PointTree {
 public:
  // \param points  [P], any frame
  // \pre the points are finite, fewer than 2^32
  explicit PointTree(std::span<const Eigen::Vector3f> points);

  // Returns the indices of the points nearest to a place, at most `count`, the
  // nearest first, none of them farther away than max_distance (units of the
  // points). Of points at the same distance the lower index comes first.
  // Points whose squared distance is no finite float are not found.
  std::vector<uint32_t> Nearest(const Eigen::Vector3f& place, size_t count,
                                float max_distance) const;

  // Returns the points that are nearer to a place than a distance, in an order
  // that depends on the points and the place alone.
  std::vector<uint32_t> Within(const Eigen::Vector3f& place,
                               float distance) const;

 private:
  // A node has the points begin ... end - 1. Few of them are a leaf; others are
  // split by the middle one, along an axis, into those before and after it.
  void Build(std::span<const Eigen::Vector3f> points, uint32_t begin,
             uint32_t end);
  template <typename Visit>
  void Search(const Eigen::Vector3f& place, uint32_t begin, uint32_t end,
              Eigen::Vector3f outside, const Visit& visit) const;

  std::vector<Eigen::Vector3f> points_;  // [P] node by node
  std::vector<uint32_t> indices_;        // [P] that the points had
  std::vector<uint8_t> axes_;            // [P] of nodes, at their middles
};

}  // namespace colmap_ext
