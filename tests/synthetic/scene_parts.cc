#include "tests/synthetic/scene_parts.h"

#include <algorithm>
#include <cmath>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {

using Eigen::Vector3f;

float SmoothMin(float a, float b, float width) {
  const float h = std::max(width - std::abs(a - b), 0.0f) / width;
  return std::min(a, b) - h * h * width * 0.25f;
}

float Ellipsoid(const Vector3f& p, const Vector3f& center,
                const Vector3f& radii) {
  const Vector3f q = (p - center).cwiseQuotient(radii);
  return (q.norm() - 1) * radii.minCoeff();
}

float RoundBox(const Vector3f& p, const Vector3f& center, const Vector3f& half,
               float radius) {
  const Vector3f q =
      (p - center).cwiseAbs() - half + Vector3f::Constant(radius);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0f) - radius;
}

float Ring(const Vector3f& p, const Vector3f& center, float radius,
           float tube) {
  const Vector3f q = p - center;
  const float from_circle = std::hypot(q.x(), q.z()) - radius;
  return std::hypot(from_circle, q.y()) - tube;
}

float Rod(const Vector3f& p, const Vector3f& from, const Vector3f& to,
          float radius) {
  const Vector3f along = to - from;
  const float t = (p - from).dot(along) / along.squaredNorm();
  return (p - from - std::clamp(t, 0.0f, 1.0f) * along).norm() - radius;
}

float Relief(const Vector3f& p, uint32_t seed) {
  const float grain = FractalNoise(p * 11, 4, 0.55f, seed);
  const float ridges = 1 - 2 * std::abs(ValueNoise(p * 14, seed + 50));
  return std::clamp(0.36f * grain + 0.3f * ridges, -1.0f, 1.0f);
}

uint32_t SurfaceSeed(const SceneOptions& options) {
  return static_cast<uint32_t>(Hash(options.seed, 1));
}

}  // namespace colmap_ext::synthetic
