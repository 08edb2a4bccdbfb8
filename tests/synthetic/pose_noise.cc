#include "tests/synthetic/dense_scene.h"

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr uint64_t kPoseNoise = 0x706f7365;  // of this use of Hash()

// [views] of zero mean, and with a mean square of 1 for each number.
std::vector<Vector6d> MakeNoise(bool is_smooth, size_t num_views,
                                uint64_t seed) {
  std::vector<Vector6d> noise(num_views, Vector6d::Zero());
  for (int k = 0; k < 6; ++k) {
    const auto number = [&](size_t i) {
      return Gaussian(Hash(seed, kPoseNoise, i, k));
    };
    for (size_t i = 0; i < num_views; ++i) {
      const double angle =
          2 * M_PI * static_cast<double>(i) / static_cast<double>(num_views);
      noise[i][k] = is_smooth ? number(0) * std::sin(angle) +
                                    number(1) * std::cos(angle) +
                                    number(2) * std::sin(2 * angle)
                              : number(i);
    }
  }
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& of_view : noise) {
    mean += of_view / static_cast<double>(num_views);
  }
  double sum = 0;
  for (Vector6d& of_view : noise) {
    of_view -= mean;
    sum += of_view.squaredNorm();
  }
  for (Vector6d& of_view : noise) {
    of_view *= std::sqrt(6 * static_cast<double>(num_views) / sum);
  }
  return noise;
}

}  // namespace

// A turn about x or y, or a motion along them, moves what lies ahead by the
// angle, or the length over the depth, times the focal length; turns about z
// and motions along it move it less. So four of six numbers share the squares.
std::vector<View> DisturbViews(const PoseNoiseOptions& options,
                               const std::vector<View>& views, double depth,
                               uint64_t seed) {
  std::vector<View> disturbed = views;
  if (options.pixels > 0 && views.size() > 1) {
    const std::vector<Vector6d> noise =
        MakeNoise(options.is_smooth, views.size(), seed);
    for (size_t i = 0; i < views.size(); ++i) {
      View& view = disturbed[i];
      const Vector6d step = noise[i] * options.pixels / (2 * view.fx);
      const Eigen::Vector3d turn = step.head<3>();
      const Eigen::Matrix3d rotation =
          Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
      view.cam_from_world_rotation = rotation * view.cam_from_world_rotation;
      view.cam_from_world_translation =
          rotation * view.cam_from_world_translation + depth * step.tail<3>();
    }
  }
  for (View& view : disturbed) {
    view.fx *= options.focal_factor;
    view.fy *= options.focal_factor;
  }
  return disturbed;
}

}  // namespace colmap_ext::synthetic
