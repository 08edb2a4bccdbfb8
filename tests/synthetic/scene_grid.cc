#include <algorithm>
#include <array>
#include <cmath>

#include "tests/synthetic/noise.h"
#include "tests/synthetic/scene_parts.h"
#include "tests/synthetic/scene_shapes.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

constexpr float kFront = -0.4f;  // the plane of the lattice, y
constexpr float kJoint = 0.02f;  // how far joints are rounded off
constexpr std::array<float, 4> kColumns = {-1.0f, -0.7f, -0.4f, -0.1f};  // x
constexpr std::array<float, 3> kRows = {-0.5f, 0.0f, 0.5f};              // z

// Four upright rods, the thinner the farther right, and three level ones; held
// by a post at each corner.
float Lattice(const Vector3f& p, float thickness) {
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

}  // namespace

Solid MakeGrid(const SceneOptions& options) {
  const uint32_t seed = SurfaceSeed(options);
  const auto thickness = static_cast<float>(options.thickness);
  Solid solid;
  // The outside of the backdrop is where y < 0.
  solid.box = {Vector3f(-1.4f, -0.62f, -0.95f), Vector3f(1.4f, 0.25f, 0.95f)};
  solid.shape = [seed, thickness](const Vector3f& p) {
    const float backdrop = 0.05f * ValueNoise(p * 2.3f, seed + 90) - p.y();
    const float thin =
        std::min(Lattice(p, thickness),
                 std::min(Blades(p, thickness), Gable(p, thickness)));
    return SmoothMin(backdrop, thin, 2 * kJoint);
  };
  solid.max_detail = static_cast<float>(0.018 * options.relief);
  solid.detail = [seed, scale = solid.max_detail](const Vector3f& p) {
    // Relief as high as that of the backdrop would cut the rods.
    const float share = std::clamp(1 + 12 * (p.y() + 0.06f), 0.12f, 1.0f);
    return -scale * share * Relief(p, seed);
  };
  return solid;
}

}  // namespace colmap_ext::synthetic
