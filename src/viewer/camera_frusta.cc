#include "viewer/camera_frusta.h"

#include <algorithm>
#include <limits>

#include "base/percentile.h"

namespace colmap_ext {

std::array<Eigen::Vector3d, 4> ImageCorners(const View& view, double depth) {
  const Eigen::Matrix3d ray_from_pixel = view.RayFromPixel();
  std::array<Eigen::Vector3d, 4> corners;
  for (int i = 0; i < 4; ++i) {
    const int below = i / 2;
    const Eigen::Vector3d pixel(i % 2 * view.width, below * view.height, 1);
    corners[i] = view.Center() + depth * (ray_from_pixel * pixel);
  }
  return corners;
}

std::vector<Eigen::Vector3f> FrustumLines(const std::vector<View>& views,
                                          double depth) {
  constexpr std::array<int, 8> kAround = {0, 1, 1, 3, 3, 2, 2, 0};
  std::vector<Eigen::Vector3f> ends;
  for (const View& view : views) {
    const std::array<Eigen::Vector3d, 4> corners = ImageCorners(view, depth);
    for (const Eigen::Vector3d& corner : corners) {
      ends.emplace_back(view.Center().cast<float>());
      ends.emplace_back(corner.cast<float>());
    }
    for (const int i : kAround) {
      ends.emplace_back(corners[i].cast<float>());
    }
  }
  return ends;
}

double FrustumDepth(const std::vector<View>& views) {
  constexpr double kShare = 0.4;     // of the way to the next camera
  constexpr size_t kMaxAsked = 200;  // cameras; a choice
  std::vector<double> distances;
  for (size_t i = 0; i < std::min(views.size(), kMaxAsked); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t j = 0; j < views.size(); ++j) {
      const double distance = (views[i].Center() - views[j].Center()).norm();
      nearest = distance > 0 ? std::min(nearest, distance) : nearest;
    }
    if (nearest < std::numeric_limits<double>::infinity()) {
      distances.push_back(nearest);
    }
  }
  return distances.empty() ? 1 : kShare * Median(&distances);
}

}  // namespace colmap_ext
