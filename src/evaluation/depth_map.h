#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mesh/bvh.h"
#include "scene/view.h"

namespace colmap_ext {

// Depths along the z axis of a view, of the whole image or of some pixels of
// it: every `stride`-th of every `stride`-th row, from the middle of the first
// `stride` on.
struct DepthMap {
  int width = 0;              // samples a row
  int height = 0;             // rows of samples
  int stride = 1;             // px
  std::vector<float> depths;  // [height * width], scene units; 0: nothing seen

  // The pixel, on either axis, of a row's or column's samples.
  int Pixel(int sample) const { return sample * stride + stride / 2; }

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// What a view sees of a surface, a ray through the centre of each sampled
// pixel.
// \param stride  > 0
DepthMap RenderDepths(const Bvh& surface, const View& view, int stride);

// The same pixels of a map of the whole image.
// \pre map.stride == 1
DepthMap Subsample(const DepthMap& map, int stride);

// World points of the samples of `depths` at which `mask` has a depth as well,
// row by row.
// \pre both are of the same size
std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view);

}  // namespace colmap_ext
