#include "delaunay/space_filling_curve.h"

#include <algorithm>

namespace colmap_ext {
namespace {

// Puts two zero bits in front of each of the lower 21 bits.
uint64_t Spread(uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2) & 0x1249249249249249ULL;
  return x;
}

}  // namespace

std::vector<uint64_t> MortonKeys(const std::vector<Eigen::Vector3f>& points) {
  std::vector<uint64_t> keys(points.size());
  if (points.empty()) {
    return keys;
  }
  Eigen::Vector3d lower = points.front().cast<double>();
  Eigen::Vector3d upper = lower;
  for (const Eigen::Vector3f& point : points) {
    lower = lower.cwiseMin(point.cast<double>());
    upper = upper.cwiseMax(point.cast<double>());
  }
  // Cells an axis: three times 21 bits fit into 64.
  constexpr double kCells = (1 << 21) - 1;
  const double extent = (upper - lower).maxCoeff();
  const double scale = extent > 0 ? kCells / extent : 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = (points[i].cast<double>() - lower) * scale;
    keys[i] = Spread(static_cast<uint64_t>(p.x())) |
              Spread(static_cast<uint64_t>(p.y())) << 1 |
              Spread(static_cast<uint64_t>(p.z())) << 2;
  }
  return keys;
}

}  // namespace colmap_ext
