#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns a map without depths, of every stride-th pixel of every such row of
// an image.
// \param width, height  of the image, px
// \param stride  px, > 0
inline DepthMap EmptyDepths(int width, int height, int stride) {
  DepthMap map;
  map.stride = stride;
  map.width = (width - stride / 2 + stride - 1) / stride;
  map.height = (height - stride / 2 + stride - 1) / stride;
  map.depths.resize(static_cast<size_t>(map.width) * map.height, 0);
  return map;
}

// Returns every stride-th pixel of a map of the whole image.
// \param stride  px, > 0
// \pre map.stride == 1
inline DepthMap Subsample(const DepthMap& map, int stride) {
  DepthMap samples = EmptyDepths(map.width, map.height, stride);
  for (int row = 0; row < samples.height; ++row) {
    for (int col = 0; col < samples.width; ++col) {
      samples.depths[samples.Index(row, col)] =
          map.depths[map.Index(samples.Pixel(row), samples.Pixel(col))];
    }
  }
  return samples;
}

// Returns the points of `depths` where `mask` has a depth too, world frame, row
// by row.
// \pre both are of the same size
inline std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
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
