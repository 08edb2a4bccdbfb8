#include "mesh/space_filling_curve.h"

#include <algorithm>
#include <numeric>

#include <tbb/parallel_sort.h>

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

std::vector<uint32_t> SortAlongCurve(TriangleMesh* mesh) {
  const std::vector<uint64_t> keys = MortonKeys(mesh->vertices);
  std::vector<uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
  });
  std::vector<Eigen::Vector3f> vertices(order.size());
  std::vector<uint32_t> places(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    vertices[i] = mesh->vertices[order[i]];
    places[order[i]] = i;
  }
  mesh->vertices = std::move(vertices);
  for (Facet& facet : mesh->facets) {
    facet = {places[facet[0]], places[facet[1]], places[facet[2]]};
  }
  std::ranges::stable_sort(mesh->facets, {}, [](const Facet& facet) {
    return *std::ranges::min_element(facet);
  });
  return order;
}

}  // namespace colmap_ext
