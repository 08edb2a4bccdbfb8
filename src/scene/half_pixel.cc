#include "scene/half_pixel.h"

#include <tbb/parallel_for.h>

namespace colmap_ext {

std::vector<Eigen::Vector3f> HalfPixelOffsets(
    const PointCloud& cloud, const std::vector<View>& views,
    const std::vector<double>& depth_map_scales) {
  std::vector<Eigen::Vector3f> offsets(cloud.size(), Eigen::Vector3f::Zero());
  tbb::parallel_for(size_t{0}, cloud.size(), [&](size_t point) {
    const auto seen_by = cloud.views[point];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const uint32_t index : seen_by) {
      const View& view = views[index];
      const double scale =
          depth_map_scales.empty() ? 1 : depth_map_scales[index];
      const double depth =
          view.CamFromWorld(cloud.positions[point].cast<double>()).z();
      sum += view.cam_from_world_rotation.transpose() *
             Eigen::Vector3d(0.5 * depth / (view.fx * scale),
                             0.5 * depth / (view.fy * scale), 0);
    }
    if (!seen_by.empty()) {
      offsets[point] =
          (sum / static_cast<double>(seen_by.size())).cast<float>();
    }
  });
  return offsets;
}

}  // namespace colmap_ext
