#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

namespace colmap_ext {

// Space cut by planes across the axes into parts of about equal weight.
class SplitTree {
 public:
  // Each part is cut where its weight is shared out, across the axis along
  // which its points spread most.
  // \param weights [points] positive
  // \param num_parts 1 or more, at most the number of points
  SplitTree(const std::vector<Eigen::Vector3f>& points,
            const std::vector<float>& weights, size_t num_parts);

  // Points at one place are in one part.
  uint32_t PartOf(const Eigen::Vector3f& point) const;

  // [parts] the boxes of the parts, infinite outwards.
  std::vector<Eigen::AlignedBox3f> Cells() const;

 private:
  struct Node {
    int axis = 0;
    float border = 0;      // coordinates below are in the first child
    uint32_t children[2];  // nodes, or kLeaf + part
  };
  static constexpr uint32_t kLeaf = 1u << 31;

  std::vector<Node> nodes_;
  uint32_t root_ = kLeaf;
};

}  // namespace colmap_ext
