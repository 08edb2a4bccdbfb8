#include "scene/depth_maps.h"

#include <cstddef>

namespace colmap_ext {

DepthMap EmptyDepths(int width, int height, int stride) {
  DepthMap map;
  map.stride = stride;
  map.width = (width - stride / 2 + stride - 1) / stride;
  map.height = (height - stride / 2 + stride - 1) / stride;
  map.depths.resize(static_cast<size_t>(map.width) * map.height, 0);
  return map;
}

DepthMap Subsample(const DepthMap& map, int stride) {
  DepthMap samples = EmptyDepths(map.width, map.height, stride);
  for (int row = 0; row < samples.height; ++row) {
    for (int col = 0; col < samples.width; ++col) {
      samples.depths[samples.Index(row, col)] =
          map.depths[map.Index(samples.Pixel(row), samples.Pixel(col))];
    }
  }
  return samples;
}

std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view) {
  const Eigen::Vector3f eye = view.Center().cast<float>();
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < depths.height; ++row) {
    for (int col = 0; col < depths.width; ++col) {
      const size_t index = depths.Index(row, col);
      if (depths.depths[index] > 0 && mask.depths[index] > 0) {
        points.emplace_back(eye + depths.depths[index] *
                                      RayDirection(view,
                                                   depths.Pixel(col) + 0.5,
                                                   depths.Pixel(row) + 0.5));
      }
    }
  }
  return points;
}

}  // namespace colmap_ext
