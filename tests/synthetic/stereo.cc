#include "tests/synthetic/stereo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/synthetic/noise.h"
#include "tests/synthetic/parallel.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

// How far a seen surface may be from a point that is said to lie on it,
// relative to its depth.
constexpr float kSameDepth = 0.006f;

struct Camera {
  Matrix3f rotation;  // camera from world
  Vector3f translation, center;
  Vector2f focal, principal;

  explicit Camera(const View& view)
      : rotation(view.cam_from_world_rotation.cast<float>()),
        translation(view.cam_from_world_translation.cast<float>()),
        center(view.Center().cast<float>()),
        focal(view.fx, view.fy),
        principal(view.cx, view.cy) {}

  Vector2f ImageFromCam(const Vector3f& p) const {
    return focal.cwiseProduct(p.head<2>() / p.z()) + principal;
  }
};

struct Matcher {
  const Scene& scene;
  const std::vector<Visible>& visible;
  const size_t reference;
  const StereoOptions& options;
  const uint64_t seed;
  std::vector<Camera> cameras;
  float min_cos_incidence;
  float min_cos_angle;

  // Whether the point is seen, from not too flat an angle, by view `source`.
  bool Sees(size_t source, const Vector3f& point, const Vector3f& normal,
            const Vector3f& to_reference) const {
    const Camera& camera = cameras[source];
    const Vector3f to_source = (camera.center - point).normalized();
    if (to_source.dot(normal) < min_cos_incidence ||
        to_source.dot(to_reference) < min_cos_angle) {
      return false;
    }
    const Vector3f in_camera = camera.rotation * point + camera.translation;
    if (in_camera.z() <= 0) {
      return false;
    }
    const Vector2f pixel = camera.ImageFromCam(in_camera);
    const Visible& seen = visible[source];
    if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < seen.width &&
          pixel.y() < seen.height)) {
      return false;
    }
    const float depth = seen.depths[seen.Index(static_cast<int>(pixel.y()),
                                               static_cast<int>(pixel.x()))];
    return std::abs(depth - in_camera.z()) < kSameDepth * in_camera.z();
  }

  // The error of a pixel's depth in deviations: what its neighbourhood shares,
  // in two sizes, and what is its own.
  float DepthNoise(int row, int col) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 10, reference));
    const float coarse = SmoothNoise(col / 17.0f, row / 17.0f, key);
    const float fine = SmoothNoise(col / 6.0f, row / 6.0f, key + 1);
    const float own = Gaussian(Hash(seed, 11, reference, row * 65536ull + col));
    const float shared = options.correlated_share;
    return std::sqrt(shared) * (0.8f * fine + 0.6f * coarse) +
           std::sqrt(1 - shared) * own;
  }

  bool DropsOut(int row, int col) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 12, reference));
    const float patch = SmoothNoise(col / 8.0f, row / 8.0f, key);
    // About one in twelve lies above 1.4 deviations.
    return patch > 1.4f &&
           Uniform(Hash(seed, 13, reference, row * 65536ull + col)) <
               12 * options.dropout;
  }

  Vector3f NoisyNormal(const Vector3f& normal, int row, int col) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 14, reference));
    const float scale = options.normal_noise * std::numbers::pi / 180;
    const float x = col / 5.0f, y = row / 5.0f;
    return (normal + scale * Vector3f(SmoothNoise(x, y, key),
                                      SmoothNoise(x, y, key + 1),
                                      SmoothNoise(x, y, key + 2)))
        .normalized();
  }

  void MatchPixel(int row, int col, DepthMap* map) const;
};

void Matcher::MatchPixel(int row, int col, DepthMap* map) const {
  const View& view = scene.views[reference];
  const size_t index = map->Index(row, col);
  const int32_t facet = visible[reference].facets[index];
  if (facet < 0 || DropsOut(row, col)) {
    return;
  }
  const Camera& camera = cameras[reference];
  const float depth = visible[reference].depths[index];
  const Vector3f point =
      camera.center + depth * RayDirection(view, col + 0.5, row + 0.5);
  Vector3f normal = Vector3f::Zero();
  for (const uint32_t vertex : scene.surface.facets[facet]) {
    normal += scene.normals[vertex];
  }
  normal.normalize();
  const Vector3f to_reference = (camera.center - point).normalized();
  if (to_reference.dot(normal) < min_cos_incidence) {
    return;
  }
  // Where COLMAP looks for the point: on the ray of the pixel's corner.
  const Vector3f direction = RayDirection(view, col, row);
  const Vector3f start = camera.center + depth * direction;
  int num_sources = 0;
  float sum_squares = 0;  // of the pixels that a unit of depth moves a match
  float sum_errors = 0;
  for (size_t source = 0; source < cameras.size(); ++source) {
    if (source == reference || !Sees(source, point, normal, to_reference)) {
      continue;
    }
    ++num_sources;
    const Camera& other = cameras[source];
    const Vector3f p = other.rotation * start + other.translation;
    const Vector3f d = other.rotation * direction;
    const Vector2f slope = other.focal.cwiseProduct(
        (d.head<2>() - p.head<2>() * (d.z() / p.z())) / p.z());
    const Vector2f match =
        other.ImageFromCam(other.rotation * point + other.translation) -
        Vector2f::Constant(0.5f);
    sum_squares += slope.squaredNorm();
    sum_errors += slope.dot(match - other.ImageFromCam(p));
  }
  if (num_sources < options.min_num_sources || !(sum_squares > 0)) {
    return;
  }
  map->depths[index] =
      depth + sum_errors / sum_squares +
      options.noise / std::sqrt(sum_squares) * DepthNoise(row, col);
  map->normals[index] = NoisyNormal(normal, row, col);
}

}  // namespace

DepthMap SimulateStereo(const Scene& scene, const std::vector<Visible>& visible,
                        size_t view, const StereoOptions& options,
                        uint64_t seed, int num_threads) {
  constexpr double kRadians = std::numbers::pi / 180;
  Matcher matcher{scene, visible, view, options, seed, {}, 0, 0};
  for (const View& v : scene.views) {
    matcher.cameras.emplace_back(v);
  }
  matcher.min_cos_incidence = std::cos(options.max_incidence * kRadians);
  matcher.min_cos_angle = std::cos(options.max_triangulation_angle * kRadians);
  DepthMap map;
  map.width = visible[view].width;
  map.height = visible[view].height;
  map.depths.resize(visible[view].depths.size(), 0);
  map.normals.resize(map.depths.size(), Vector3f::Zero());
  ParallelFor(map.height, num_threads, [&](size_t row) {
    for (int col = 0; col < map.width; ++col) {
      matcher.MatchPixel(row, col, &map);
    }
  });
  return map;
}

}  // namespace colmap_ext::synthetic
