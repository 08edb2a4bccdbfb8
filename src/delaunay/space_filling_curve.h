#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Keys of points along a Morton (z-order) curve through their bounding box:
// points whose keys are close lie close. 21 bits an axis, interleaved.
// \pre all positions are finite
std::vector<uint64_t> MortonKeys(const std::vector<Eigen::Vector3f>& points);

}  // namespace colmap_ext
