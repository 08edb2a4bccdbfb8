#include "evaluation/thinning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <tuple>

#include <tbb/parallel_sort.h>

namespace colmap_ext {
namespace {

struct GridPoint {
  std::array<int32_t, 3> cube;
  float offset_squared;  // from the cube's centre, in cubes
  Eigen::Vector3f point;
};

GridPoint Locate(const Eigen::Vector3f& point, double spacing) {
  constexpr double kMaxIndex = 2147483647;
  const Eigen::Array3d position = point.cast<double>().array() / spacing;
  const Eigen::Array3d cube = position.floor();
  if (!(cube.abs() < kMaxIndex).all()) {
    throw std::invalid_argument(
        "the spacing of the samples is too small for the extent of the scene");
  }
  GridPoint located;
  for (int i = 0; i < 3; ++i) {
    located.cube[i] = static_cast<int32_t>(cube[i]);
  }
  located.offset_squared =
      static_cast<float>((position - cube - 0.5).matrix().squaredNorm());
  located.point = point;
  return located;
}

// A total order, so that equal ones are the same point.
bool IsBefore(const GridPoint& a, const GridPoint& b) {
  const auto key = [](const GridPoint& p) {
    return std::tuple(p.cube, p.offset_squared, p.point.x(), p.point.y(),
                      p.point.z());
  };
  return key(a) < key(b);
}

}  // namespace

void Thin(double spacing, std::vector<Eigen::Vector3f>* points) {
  std::vector<GridPoint> located;
  located.reserve(points->size());
  for (const Eigen::Vector3f& point : *points) {
    located.push_back(Locate(point, spacing));
  }
  tbb::parallel_sort(located.begin(), located.end(), IsBefore);
  points->clear();
  for (size_t i = 0; i < located.size(); ++i) {
    if (i == 0 || located[i].cube != located[i - 1].cube) {
      points->push_back(located[i].point);
    }
  }
}

}  // namespace colmap_ext
