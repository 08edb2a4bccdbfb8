#pragma once

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
std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives);

// A biased randomized insertion order [Amenta2003]: random rounds of doubling
// size, each in the order of the points. Seeds are fixed.
// \param points in their order along the curve
// \return the same points
std::vector<uint32_t> InsertionOrder(const std::vector<uint32_t>& points);

}  // namespace colmap_ext
