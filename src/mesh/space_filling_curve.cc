#include "mesh/space_filling_curve.h"

#include <algorithm>
#include <bit>

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

// A lattice over the points' bounding box.
class Lattice {
 public:
  explicit Lattice(const std::vector<Eigen::Vector3f>& points) {
    Eigen::Vector3d upper = lower_ = points.front().cast<double>();
    for (const Eigen::Vector3f& point : points) {
      lower_ = lower_.cwiseMin(point.cast<double>());
      upper = upper.cwiseMax(point.cast<double>());
    }
    const double extent = (upper - lower_).maxCoeff();
    scale_ = extent > 0 ? ((1 << kKeyBits) - 1) / extent : 0;
  }

  // Of the point's cell.
  uint64_t KeyOf(const Eigen::Vector3f& point) const {
    const Eigen::Vector3d p = At(point);
    return Spread(static_cast<uint64_t>(p.x())) |
           Spread(static_cast<uint64_t>(p.y())) << 1 |
           Spread(static_cast<uint64_t>(p.z())) << 2;
  }

  // Whether a point comes before another one of its cell: by the cells that
  // 53 bits an axis give, compared by the axis whose bits differ first
  // [Chan2002], then by its coordinates.
  bool IsBefore(const Eigen::Vector3f& a, const Eigen::Vector3f& b) const {
    const Eigen::Vector3d p = kFineCells * At(a);
    const Eigen::Vector3d q = kFineCells * At(b);
    uint64_t largest = 0;
    int first = 0;
    for (const int axis : {2, 1, 0}) {
      const uint64_t difference =
          static_cast<uint64_t>(p[axis]) ^ static_cast<uint64_t>(q[axis]);
      if (std::bit_width(difference) > std::bit_width(largest)) {
        largest = difference;
        first = axis;
      }
    }
    return largest != 0 ? p[first] < q[first]
                        : std::lexicographical_compare(a.begin(), a.end(),
                                                       b.begin(), b.end());
  }

 private:
  static constexpr int kKeyBits = 21;  // an axis: three times 21 fit into 64
  static constexpr double kFineCells = 0x1p32;  // of a cell, an axis

  // In cells.
  Eigen::Vector3d At(const Eigen::Vector3f& point) const {
    return (point.cast<double>() - lower_) * scale_;
  }

  Eigen::Vector3d lower_;
  double scale_;
};

}  // namespace

std::vector<uint32_t> OrderAlongCurve(
    const std::vector<Eigen::Vector3f>& points) {
  std::vector<uint32_t> order = Iota(points.size());
  if (points.empty()) {
    return order;
  }
  const Lattice lattice(points);
  std::vector<uint64_t> keys(points.size());
  std::ranges::transform(points, keys.begin(), [&](const auto& point) {
    return lattice.KeyOf(point);
  });
  tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    if (keys[a] != keys[b]) return keys[a] < keys[b];
    if (points[a] != points[b]) return lattice.IsBefore(points[a], points[b]);
    return a < b;
  });
  return order;
}

std::vector<uint32_t> SortAlongCurve(TriangleMesh* mesh) {
  const std::vector<uint32_t> order = OrderAlongCurve(mesh->vertices);
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
