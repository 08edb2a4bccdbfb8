#include "tests/synthetic/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/view.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The parts of the solids: about the signed distances of a point from simple
// bodies, scene units.

// The smaller value, rounded off where they differ by less than `width`.
float SmoothMin(float a, float b, float width) {
  const float h = std::max(width - std::abs(a - b), 0.0f) / width;
  return std::min(a, b) - h * h * width * 0.25f;
}

float Ellipsoid(const Vector3f& p, const Vector3f& center,
                const Vector3f& radii) {
  return ((p - center).cwiseQuotient(radii).norm() - 1) * radii.minCoeff();
}

// A box with rounded edges.
float RoundBox(const Vector3f& p, const Vector3f& center, const Vector3f& half,
               float radius) {
  const Vector3f q =
      (p - center).cwiseAbs() - half + Vector3f::Constant(radius);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0f) - radius;
}

// The tube of radius `tube` around an upright circle.
float Ring(const Vector3f& p, const Vector3f& center, float radius,
           float tube) {
  const Vector3f q = p - center;
  const float from_circle = std::hypot(q.x(), q.z()) - radius;
  return std::hypot(from_circle, q.y()) - tube;
}

// A rod with round ends.
float Rod(const Vector3f& p, const Vector3f& from, const Vector3f& to,
          float radius) {
  const Vector3f along = to - from;
  const float t = (p - from).dot(along) / along.squaredNorm();
  return (p - from - std::clamp(t, 0.0f, 1.0f) * along).norm() - radius;
}

// Rounded relief of several sizes, and ridges; in [-1, 1].
float Relief(const Vector3f& p, uint32_t seed) {
  const float grain = FractalNoise(p * 11, 4, 0.55f, seed);
  const float ridges = 1 - 2 * std::abs(ValueNoise(p * 14, seed + 50));
  return std::clamp(0.36f * grain + 0.3f * ridges, -1.0f, 1.0f);
}

uint32_t SurfaceSeed(const SceneOptions& options) {
  return static_cast<uint32_t>(Hash(options.seed, 1));
}

void AddRelief(double height, uint32_t seed, Solid* solid) {
  solid->max_detail = static_cast<float>(height);
  solid->detail = [seed, scale = solid->max_detail](const Vector3f& p) {
    return -scale * Relief(p, seed);
  };
}

Solid MakeStatue(const SceneOptions& options) {
  const uint32_t seed = SurfaceSeed(options);
  Solid solid;
  solid.box = {Vector3f(-1.02f, -1.02f, -0.16f), Vector3f(1.02f, 1.02f, 1.25f)};
  solid.shape = [seed](const Vector3f& p) {
    const float tube = 0.13f + 0.035f * std::sin(5 * p.x() + 4 * p.z());
    const float ring = Ring(p, {0, 0, 0.50f}, 0.33f, tube);
    const float head = Ellipsoid(p, {0.1f, 0.05f, 0.95f}, {0.2f, 0.22f, 0.19f});
    const float foot = Ellipsoid(p, {0, 0, 0.05f}, {0.42f, 0.34f, 0.17f});
    const float knob =
        Ellipsoid(p, {-0.42f, -0.1f, 0.6f}, {0.13f, 0.2f, 0.12f});
    const float body = SmoothMin(SmoothMin(ring, head, 0.08f),
                                 SmoothMin(foot, knob, 0.05f), 0.06f);
    const float ground = p.z() - 0.045f * ValueNoise(p * 2.3f, seed + 90);
    return SmoothMin(body, ground, 0.05f);
  };
  AddRelief(0.018 * options.relief, seed, &solid);
  return solid;
}

Solid MakeWall(const SceneOptions& options) {
  const uint32_t seed = SurfaceSeed(options);
  Solid solid;
  // The wall is the plane y = 0, its outside is where y < 0.
  solid.box = {Vector3f(-1.4f, -0.62f, -0.95f), Vector3f(1.4f, 0.42f, 0.95f)};
  solid.shape = [](const Vector3f& p) {
    const float x = std::abs(p.x());
    const Vector3f q(x, p.y(), p.z());
    float wall = -RoundBox(q, {0.5f, 0, 0.12f}, {0.25f, 0.25f, 0.5f}, 0.12f);
    wall = std::max(-p.y(), wall);
    const float column =
        std::hypot(x - 0.98f, p.y() + 0.05f) - 0.13f +
        0.012f * std::sin(9 * std::atan2(p.y() + 0.05f, x - 0.98f));
    const float cornice = RoundBox(q, {0, 0, 0.76f}, {2, 0.2f, 0.07f}, 0.04f);
    const float basin =
        RoundBox(q, {0, -0.1f, -0.75f}, {0.85f, 0.32f, 0.12f}, 0.06f);
    const float bust =
        Ellipsoid(q, {0.5f, 0.14f, -0.1f}, {0.14f, 0.14f, 0.25f});
    const float head = Ellipsoid(q, {0.5f, 0.1f, 0.2f}, {0.08f, 0.09f, 0.1f});
    const float boss = Ellipsoid(q, {0, 0, 0.2f}, {0.14f, 0.16f, 0.2f});
    float solid_value = SmoothMin(wall, SmoothMin(bust, head, 0.05f), 0.04f);
    solid_value =
        SmoothMin(solid_value, SmoothMin(column, cornice, 0.02f), 0.03f);
    return SmoothMin(solid_value, SmoothMin(basin, boss, 0.02f), 0.03f);
  };
  AddRelief(0.015 * options.relief, seed, &solid);
  return solid;
}

constexpr float kFront = -0.4f;  // the plane of the lattice, y
constexpr float kJoint = 0.02f;  // how far joints are rounded off
constexpr std::array<float, 4> kColumns = {-1.0f, -0.7f, -0.4f, -0.1f};  // x
constexpr std::array<float, 3> kRows = {-0.5f, 0.0f, 0.5f};              // z

// Four upright rods, the thinner the farther right, and three level ones; held
// by a post at each corner.
float RodLattice(const Vector3f& p, float thickness) {
  constexpr std::array<float, 4> kRadii = {0.036f, 0.026f, 0.018f, 0.014f};
  float value = 1e9f;
  for (size_t i = 0; i < kColumns.size(); ++i) {
    const Vector3f bottom(kColumns[i], kFront, kRows.front());
    const Vector3f top(kColumns[i], kFront, kRows.back());
    value = std::min(value, Rod(p, bottom, top, thickness * kRadii[i]));
  }
  for (const float z : kRows) {
    value = SmoothMin(value,
                      Rod(p, {kColumns.front(), kFront, z},
                          {kColumns.back(), kFront, z}, 0.02f * thickness),
                      kJoint);
  }
  for (const float x : {kColumns.front(), kColumns.back()}) {
    for (const float z : {kRows.front(), kRows.back()}) {
      value = SmoothMin(value,
                        Rod(p, {x, kFront, z}, {x, 0.1f, z}, 0.03f * thickness),
                        kJoint);
    }
  }
  return value;
}

// Upright blades on the backdrop, with slots between them.
float Blades(const Vector3f& p, float thickness) {
  constexpr std::array<float, 4> kDepths = {0.42f, 0.34f, 0.25f, 0.16f};
  float value = 1e9f;
  for (size_t i = 0; i < kDepths.size(); ++i) {
    const float half = 0.013f * thickness;
    value = std::min(
        value, RoundBox(p, {0.25f + 0.25f * i, 0.05f - 0.5f * kDepths[i], 0},
                        {half, 0.05f + 0.5f * kDepths[i], 0.62f}, 0.9f * half));
  }
  return value;
}

// Two rods that meet in front of the lattice.
float Gable(const Vector3f& p, float thickness) {
  const Vector3f tip(-0.55f, -0.5f, 0.72f);
  const float radius = 0.022f * thickness;
  return std::min(Rod(p, {-1.2f, 0.1f, 0.72f}, tip, radius),
                  Rod(p, {0.1f, 0.1f, 0.72f}, tip, radius));
}

Solid MakeGrid(const SceneOptions& options) {
  const uint32_t seed = SurfaceSeed(options);
  const auto thickness = static_cast<float>(options.thickness);
  Solid solid;
  // The outside of the backdrop is where y < 0.
  solid.box = {Vector3f(-1.4f, -0.62f, -0.95f), Vector3f(1.4f, 0.25f, 0.95f)};
  solid.shape = [seed, thickness](const Vector3f& p) {
    const float backdrop = 0.05f * ValueNoise(p * 2.3f, seed + 90) - p.y();
    const float thin =
        std::min(RodLattice(p, thickness),
                 std::min(Blades(p, thickness), Gable(p, thickness)));
    return SmoothMin(backdrop, thin, 2 * kJoint);
  };
  solid.max_detail = static_cast<float>(0.018 * options.relief);
  solid.detail = [seed, scale = solid.max_detail](const Vector3f& p) {
    // Full relief would cut the rods.
    const float share = std::clamp(1 + 12 * (p.y() + 0.06f), 0.12f, 1.0f);
    return -scale * share * Relief(p, seed);
  };
  return solid;
}

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

// Cameras all around the origin, in two rows.
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

// Cameras on an arc in front of the plane y = 0.
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

}  // namespace

const SceneShape* FindSceneShape(const std::string& name) {
  static const std::vector<SceneShape> kShapes = {
      {"statue", MakeStatue, MakeViewsAround, Vector3f(0.5f, -0.35f, 0.8f),
       Patch{{-0.45f, -0.1f, 0.6f}, 0.24f}, Patch{{0.1f, 0.05f, 1.0f}, 0.25f}},
      {"wall", MakeWall, MakeViewsBefore, Vector3f(-0.5f, -0.75f, 0.5f),
       Patch{{0, 0, -0.3f}, 0.24f}, Patch{{-0.5f, 0, 0}, 0.4f}},
      {"grid", MakeGrid, MakeViewsBefore, Vector3f(-0.5f, -0.75f, 0.5f),
       Patch{{-0.55f, 0, 0.25f}, 0.24f}, Patch{{0.75f, -0.2f, 0}, 0.4f}}};
  const auto shape = std::ranges::find(kShapes, name, &SceneShape::name);
  return shape == kShapes.end() ? nullptr : &*shape;
}

}  // namespace colmap_ext::synthetic
