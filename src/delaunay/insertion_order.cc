#include "delaunay/insertion_order.h"

#include <bit>
#include <numeric>

#include <tbb/parallel_sort.h>

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
  const std::vector<uint64_t> keys = MortonKeys(positions);
  std::vector<uint32_t> points(positions.size());
  std::iota(points.begin(), points.end(), 0);
  tbb::parallel_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) {
    if (keys[a] != keys[b]) return keys[a] < keys[b];
    const auto& p = positions[a];
    const auto& q = positions[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  });
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

std::vector<uint32_t> InsertionOrder(const std::vector<uint32_t>& points) {
  // A point is in round k with probability 2^-(k + 1): its hash starts with k
  // zero bits.
  std::vector<uint8_t> rounds(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    rounds[i] = static_cast<uint8_t>(std::countl_zero(Hash(i) | 1));
  }
  std::vector<uint32_t> order;
  order.reserve(points.size());
  for (int round = 63; round >= 0; --round) {
    for (size_t i = 0; i < points.size(); ++i) {
      if (rounds[i] == round) {
        order.push_back(points[i]);
      }
    }
  }
  return order;
}

}  // namespace colmap_ext
