#include "pictures/point_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace colmap_ext {

ColorImage DrawPoints(const PointCloud& cloud, const View& view, int side) {
  constexpr Color kGray = {128, 128, 128};
  const size_t num_pixels = static_cast<size_t>(view.width) * view.height;
  ColorImage image{view.width, view.height,
                   std::vector<Color>(num_pixels, {255, 255, 255})};
  std::vector<double> depths(num_pixels,
                             std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point =
        view.CamFromWorld(cloud.positions[i].cast<double>());
    if (!(point.z() > 0)) {
      continue;
    }
    const Eigen::Vector2d corner =
        view.ImageFromCam(point).array() - 0.5 * side;
    if (!(corner.x() > -side && corner.x() < view.width && corner.y() > -side &&
          corner.y() < view.height)) {
      continue;
    }
    const int left = static_cast<int>(std::lround(corner.x()));
    const int top = static_cast<int>(std::lround(corner.y()));
    for (int row = std::max(top, 0); row < std::min(top + side, view.height);
         ++row) {
      for (int col = std::max(left, 0); col < std::min(left + side, view.width);
           ++col) {
        const size_t pixel = static_cast<size_t>(row) * view.width + col;
        if (point.z() < depths[pixel]) {
          depths[pixel] = point.z();
          image.pixels[pixel] = cloud.colors.empty() ? kGray : cloud.colors[i];
        }
      }
    }
  }
  return image;
}

}  // namespace colmap_ext
