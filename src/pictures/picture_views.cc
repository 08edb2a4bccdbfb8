#include "pictures/picture_views.h"

#include <algorithm>
#include <limits>

#include <Eigen/Eigenvalues>

#include "base/percentile.h"
#include "mesh/normals.h"
#include "scene/look_at.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Chosen by eye.
constexpr double kFocalLength = 1.5;  // widths of the picture
constexpr double kKeptPercent = 98;   // of the points are in the picture
constexpr double kDistance = 1.1;     // times the smallest that shows them all

// A ball around most of the points.
struct Ball {
  Vector3d center;
  double radius;
};

Ball BallAround(const std::vector<Vector3f>& points) {
  Ball ball;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(points, values.begin(),
                           [axis](const auto& point) { return point[axis]; });
    ball.center[axis] = Median(&values);
  }
  std::ranges::transform(points, values.begin(), [&](const auto& point) {
    return (point.template cast<double>() - ball.center).norm();
  });
  ball.radius = Percentile(kKeptPercent, &values);
  return ball;
}

// The axes along which the points within the ball extend least, more and most.
Eigen::Matrix3d PrincipalAxes(const std::vector<Vector3f>& points,
                              const Ball& ball) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vector3f& point : points) {
    const Vector3d d = point.cast<double>() - ball.center;
    if (d.norm() <= ball.radius) {
      covariance += d * d.transpose();
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance)
      .eigenvectors();
}

}  // namespace

View AutomaticView(const std::vector<Vector3f>& points, const Vector3d& front,
                   int width, int height) {
  const double focal_length = kFocalLength * width;
  if (points.empty()) {
    return LookAtView({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, width, height,
                      focal_length);
  }
  const Ball ball = BallAround(points);
  const Eigen::Matrix3d axes = PrincipalAxes(points, ball);
  Vector3d broad_side = axes.col(0);
  if (broad_side.dot(front) < 0) {
    broad_side = -broad_side;
  }
  const Vector3d direction =
      (broad_side - 0.6 * axes.col(1) + 0.25 * axes.col(2)).normalized();
  const double distance =
      kDistance * ball.radius * 2 * focal_length / std::min(width, height);
  return LookAtView(ball.center + distance * direction, ball.center, broad_side,
                    width, height, focal_length);
}

View AutomaticView(const TriangleMesh& mesh, int width, int height) {
  Vector3d sum_of_normals = Vector3d::Zero();  // weighted by area
  for (const Facet& facet : mesh.facets) {
    sum_of_normals += AreaVector(mesh, facet).cast<double>();
  }
  return AutomaticView(mesh.vertices, sum_of_normals, width, height);
}

View CropView(const View& view, double zoom, double u, double v, int width,
              int height) {
  const double scale =
      zoom * std::min(static_cast<double>(width) / view.width,
                      static_cast<double>(height) / view.height);
  View crop = view;
  crop.width = width;
  crop.height = height;
  crop.fx = view.fx * scale;
  crop.fy = view.fy * scale;
  crop.cx = (view.cx - u * view.width) * scale + 0.5 * width;
  crop.cy = (view.cy - v * view.height) * scale + 0.5 * height;
  return crop;
}

std::vector<size_t> SpreadViews(const std::vector<View>& views,
                                const std::vector<size_t>& num_seen,
                                size_t count) {
  const auto most = std::max_element(num_seen.begin(), num_seen.end());
  if (most == num_seen.end() || *most == 0 || count == 0) {
    return {};
  }
  std::vector<size_t> chosen = {static_cast<size_t>(most - num_seen.begin())};
  // Distance to the nearest chosen view; 0 for views that see too little.
  std::vector<double> distances(views.size(),
                                std::numeric_limits<double>::infinity());
  while (chosen.size() < count) {
    for (size_t i = 0; i < views.size(); ++i) {
      const double distance =
          (views[i].Center() - views[chosen.back()].Center()).norm();
      distances[i] =
          2 * num_seen[i] >= *most ? std::min(distances[i], distance) : 0;
    }
    const auto farthest = std::max_element(distances.begin(), distances.end());
    if (*farthest == 0) {
      break;
    }
    chosen.push_back(farthest - distances.begin());
  }
  return chosen;
}

}  // namespace colmap_ext
