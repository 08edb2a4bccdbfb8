#include "tests/synthetic/dense_scene.h"

#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// How far a seen surface may be from a point that is said to lie on it,
// relative to its depth.
constexpr double kDepthTolerance = 0.004;
constexpr size_t kMinTrackLength = 3;

bool Sees(const View& view, const Visible& visible, const Vector3d& point) {
  const std::optional<Vector2d> pixel = PixelInImage(view, point);
  if (!pixel) {
    return false;
  }
  const double expected = view.CamFromWorld(point).z();
  const double depth = visible.depths[visible.Index(
      static_cast<int>(pixel->y()), static_cast<int>(pixel->x()))];
  return std::abs(depth - expected) < kDepthTolerance * expected;
}

// Least squares of the reprojection errors, by Gauss and Newton from `start`,
// which is close.
Vector3d Triangulate(const std::vector<View>& views,
                     const std::vector<Feature>& track, const Vector3d& start) {
  Vector3d point = start;
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Vector3d right_side = Vector3d::Zero();
    for (const Feature& feature : track) {
      const View& view = views[feature.view];
      const Vector3d p = view.CamFromWorld(point);
      Eigen::Matrix<double, 2, 3> jacobian;
      jacobian << view.fx / p.z(), 0, -view.fx * p.x() / (p.z() * p.z()), 0,
          view.fy / p.z(), -view.fy * p.y() / (p.z() * p.z());
      jacobian = jacobian * view.cam_from_world_rotation;
      normal_matrix += jacobian.transpose() * jacobian;
      right_side +=
          jacobian.transpose() * (feature.position - view.ImageFromCam(p));
    }
    point += normal_matrix.ldlt().solve(right_side);
  }
  return point;
}

// Where some of the views that see a point find it, with noise.
std::vector<Feature> FindFeatures(const Scene& scene,
                                  const std::vector<Visible>& visible,
                                  const SparseOptions& options,
                                  const Vector3d& point, uint64_t hash) {
  std::vector<Feature> track;
  for (uint32_t v = 0; v < scene.views.size(); ++v) {
    if (!Sees(scene.views[v], visible[v], point) ||
        Uniform(Hash(hash, 3, v)) >= options.match_share) {
      continue;
    }
    const Vector2d error(Gaussian(Hash(hash, 4, v)),
                         Gaussian(Hash(hash, 5, v)));
    const Vector2d exact =
        scene.views[v].ImageFromCam(scene.views[v].CamFromWorld(point));
    track.push_back({v, exact + options.noise * error});
  }
  return track;
}

// Mean distance, px, between the features and the point's images.
double ReprojectionError(const std::vector<View>& views,
                         const SparsePoint& point) {
  double error = 0;
  for (const Feature& feature : point.track) {
    const View& view = views[feature.view];
    error += (view.ImageFromCam(view.CamFromWorld(point.position)) -
              feature.position)
                 .norm() /
             point.track.size();
  }
  return error;
}

}  // namespace

std::vector<SparsePoint> MakeSparsePoints(const Scene& scene,
                                          const std::vector<Visible>& visible,
                                          const std::vector<ColorImage>& images,
                                          const SparseOptions& options,
                                          uint64_t seed) {
  std::vector<SparsePoint> points;
  for (int i = 0; i < options.num_points; ++i) {
    const uint64_t hash = Hash(seed, 30, i);
    const size_t first = i % scene.views.size();
    const View& view = scene.views[first];
    const int row = Hash(hash, 1) % view.height;
    const int col = Hash(hash, 2) % view.width;
    const double depth = visible[first].depths[visible[first].Index(row, col)];
    if (depth <= 0) {
      continue;
    }
    const Vector3d truth =
        view.Center() +
        depth * RayDirection(view, col + 0.5, row + 0.5).cast<double>();
    SparsePoint point;
    point.track = FindFeatures(scene, visible, options, truth, hash);
    if (point.track.size() < kMinTrackLength) {
      continue;
    }
    point.position = Triangulate(scene.views, point.track, truth);
    point.error = ReprojectionError(scene.views, point);
    if (!images.empty()) {
      point.color = images[first].At(row, col);
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace colmap_ext::synthetic
