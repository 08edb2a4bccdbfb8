#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// The points without repeats, in their order along the Morton curve. Of points
// at one position the first is kept.
// \param representatives [P] is set to the point that is kept at each point's
//        position
// \return indices of points
// \pre all positions are finite
// \throw std::invalid_argument if there are more than 32 bits can number.
std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives);

// A biased randomized insertion order [Amenta2003]: random rounds of doubling
// size, each in ascending order. Seeds are fixed.
// \param num_points  along the curve
// \return [num_points] indices of points
std::vector<uint32_t> InsertionOrder(size_t num_points);

}  // namespace colmap_ext
