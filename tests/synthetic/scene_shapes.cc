#include "tests/synthetic/scene_shapes.h"

#include <algorithm>
#include <cmath>

#include "tests/synthetic/noise.h"
#include "tests/synthetic/scene_parts.h"

namespace colmap_ext::synthetic {

using Eigen::Vector3f;

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
  solid.max_detail = static_cast<float>(0.018 * options.relief);
  solid.detail = [seed, scale = solid.max_detail](const Vector3f& p) {
    return -scale * Relief(p, seed);
  };
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
  solid.max_detail = static_cast<float>(0.015 * options.relief);
  solid.detail = [seed, scale = solid.max_detail](const Vector3f& p) {
    return -scale * Relief(p, seed);
  };
  return solid;
}

const SceneShape* FindSceneShape(const std::string& name) {
  static const std::vector<SceneShape> kShapes = {
      {"statue", MakeStatue, MakeViewsAround, Vector3f(0.5f, -0.35f, 0.8f),
       Patch{{-0.45f, -0.1f, 0.6f}, 0.24f}, Patch{{0.1f, 0.05f, 1.0f}, 0.25f}},
      {"wall", MakeWall, MakeViewsBefore, Vector3f(-0.5f, -0.75f, 0.5f),
       Patch{{0, 0, -0.3f}, 0.24f}, Patch{{-0.5f, 0, 0}, 0.4f}},
      {"grid", MakeGrid, MakeViewsBefore, Vector3f(-0.5f, -0.75f, 0.5f),
       Patch{{-0.55f, 0, 0.25f}, 0.24f}, Patch{{0.75f, -0.2f, 0}, 0.4f}}};
  const auto shape =
      std::find_if(kShapes.begin(), kShapes.end(),
                   [&](const SceneShape& s) { return s.name == name; });
  return shape == kShapes.end() ? nullptr : &*shape;
}

}  // namespace colmap_ext::synthetic
