#include "delaunay/insertion_order.h"

#include <array>
#include <bit>
#include <numeric>

#include "base/index_limit.h"
#include "base/mix_bits.h"
#include "mesh/space_filling_curve.h"

namespace colmap_ext {
namespace {

// The i-th number of SplitMix64.
uint64_t Hash(uint64_t i) { return MixBits((i + 1) * kSplitMixStep); }

}  // namespace

std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives) {
  ExpectIndexable(positions.size(), "points");
  std::vector<uint32_t> points = OrderAlongCurve(positions);
  representatives->resize(positions.size());
  size_t size = 0;
  for (const uint32_t point : points) {
    if (size == 0 || positions[points[size - 1]] != positions[point]) {
      points[size++] = point;
    }
    (*representatives)[point] = points[size - 1];
  }
  points.resize(size);
  return points;
}

std::vector<uint32_t> InsertionOrder(size_t num_points) {
  // A point is in round k with probability 2^-(k + 1): its hash starts with k
  // zero bits.
  constexpr int kNumRounds = 64;
  std::array<size_t, kNumRounds + 1> ends = {};  // [63 - round]
  const auto slot = [](size_t point) {
    return kNumRounds - 1 - std::countl_zero(Hash(point) | 1);
  };
  for (size_t point = 0; point < num_points; ++point) {
    ++ends[slot(point) + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<uint32_t> order(num_points);
  for (size_t point = 0; point < num_points; ++point) {
    order[ends[slot(point)]++] = static_cast<uint32_t>(point);
  }
  return order;
}

}  // namespace colmap_ext
