#include <cmath>
#include <numbers>

#include "scene/look_at.h"
#include "tests/synthetic/noise.h"
#include "tests/synthetic/scene_shapes.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3d;

constexpr double kFocalLength = 1.2;  // in widths of the image

// A camera that looks from `eye` to `target`, z up in the world, turned by
// `roll` (rad) around its axis.
View LookAtWithRoll(const SceneOptions& options, const Vector3d& eye,
                    const Vector3d& target, double roll) {
  View view = LookAtView(eye, target, Vector3d::UnitZ(), options.width,
                         options.height, kFocalLength * options.width);
  Eigen::Matrix3d& rotation = view.cam_from_world_rotation;
  const Eigen::RowVector3d level = rotation.row(0);
  const Eigen::RowVector3d down = rotation.row(1);
  rotation.row(0) = std::cos(roll) * level + std::sin(roll) * down;
  rotation.row(1) = std::cos(roll) * down - std::sin(roll) * level;
  view.cam_from_world_translation = -rotation * eye;
  return view;
}

// Uniform in [-1, 1], for the k-th number of a camera.
double Jitter(const SceneOptions& options, int camera, int k) {
  return 2 * Uniform(Hash(options.seed, 2, camera, k)) - 1;
}

}  // namespace

std::vector<View> MakeViewsAround(const SceneOptions& options) {
  std::vector<View> views;
  for (int i = 0; i < options.num_images; ++i) {
    const double turn = 2 * std::numbers::pi *
                        (i + 0.2 * Jitter(options, i, 0)) / options.num_images;
    const double elevation =
        (i % 2 == 0 ? 0.38 : 0.72) + 0.05 * Jitter(options, i, 1);
    const double distance = 3.35 + 0.15 * Jitter(options, i, 2);
    const Vector3d target(0.05 * Jitter(options, i, 3),
                          0.05 * Jitter(options, i, 4),
                          0.40 + 0.04 * Jitter(options, i, 5));
    const Vector3d direction(std::cos(elevation) * std::cos(turn),
                             std::cos(elevation) * std::sin(turn),
                             std::sin(elevation));
    views.push_back(LookAtWithRoll(options, target + distance * direction,
                                   target, 0.05 * Jitter(options, i, 6)));
  }
  return views;
}

std::vector<View> MakeViewsBefore(const SceneOptions& options) {
  std::vector<View> views;
  for (int i = 0; i < options.num_images; ++i) {
    const double share =
        options.num_images == 1 ? 0.5 : i / (options.num_images - 1.0);
    const double turn = 1.5 * (share - 0.5) + 0.03 * Jitter(options, i, 0);
    const double distance = 2.7 + 0.15 * Jitter(options, i, 1);
    const Vector3d target(0.12 * Jitter(options, i, 2), 0,
                          -0.05 + 0.05 * Jitter(options, i, 3));
    const Vector3d eye(distance * std::sin(turn), -distance * std::cos(turn),
                       (i % 2 == 0 ? -0.1 : 0.3) + 0.1 * Jitter(options, i, 4));
    views.push_back(
        LookAtWithRoll(options, eye, target, 0.04 * Jitter(options, i, 5)));
  }
  return views;
}

}  // namespace colmap_ext::synthetic
