#include "evaluation/voxel_downsampling.h"

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
  std::array<int32_t, 3> voxel;
  float offset_squared;  // from the voxel's centre, in voxels
  Eigen::Vector3f point;
};

GridPoint Locate(const Eigen::Vector3f& point, double spacing) {
  constexpr double kMaxIndex = 2147483647;
  const Eigen::Array3d position = point.cast<double>().array() / spacing;
  const Eigen::Array3d voxel = position.floor();
  if (!(voxel.abs() < kMaxIndex).all()) {
    throw std::invalid_argument(
        "the spacing of the samples is too small for the extent of the scene");
  }
  GridPoint located;
  for (int i = 0; i < 3; ++i) {
    located.voxel[i] = static_cast<int32_t>(voxel[i]);
  }
  located.offset_squared =
      static_cast<float>((position - voxel - 0.5).matrix().squaredNorm());
  located.point = point;
  return located;
}

// A total order, so that points that compare equal are equal.
bool IsBefore(const GridPoint& a, const GridPoint& b) {
  const auto key = [](const GridPoint& p) {
    return std::tuple(p.voxel, p.offset_squared, p.point.x(), p.point.y(),
                      p.point.z());
  };
  return key(a) < key(b);
}

}  // namespace

void DownsampleByVoxels(double spacing, std::vector<Eigen::Vector3f>* points) {
  std::vector<GridPoint> located;
  located.reserve(points->size());
  for (const Eigen::Vector3f& point : *points) {
    located.push_back(Locate(point, spacing));
  }
  tbb::parallel_sort(located.begin(), located.end(), IsBefore);
  points->clear();
  for (size_t i = 0; i < located.size(); ++i) {
    if (i == 0 || located[i].voxel != located[i - 1].voxel) {
      points->push_back(located[i].point);
    }
  }
}

}  // namespace colmap_ext
