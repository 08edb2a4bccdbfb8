#include "tests/synthetic/dense_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

// Maximum distance of a point from the visible surface, relative to its depth.
constexpr float kSameDepth = 0.006f;

// Least relative difference of depth between foreground and background.
constexpr float kSilhouette = 0.02f;

// Maximum difference of a highlight between two images that are matched.
constexpr float kSameHighlight = 0.1f;

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

struct PixelIndex {
  int row, col;
};

// A point of the surface that a pixel sees.
struct SurfacePoint {
  Vector3f position, normal;
  float depth;      // in the reference view
  float blank;      // how much texture is missing, [0, 1]
  float highlight;  // as the reference view has it
};

// Sums of the matches in the other images that see a point, for the least
// squares of its depth.
struct DepthFit {
  int num_sources = 0;
  float sum_squares = 0;  // of the pixels that a unit of depth moves a match
  float sum_errors = 0;
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

  // Whether the point is seen, from not too flat an angle and in the same
  // light, by view `source`.
  bool Sees(size_t source, const SurfacePoint& point) const {
    const Camera& camera = cameras[source];
    const Vector3f to_source = (camera.center - point.position).normalized();
    const Vector3f to_reference =
        (cameras[reference].center - point.position).normalized();
    if (to_source.dot(point.normal) < min_cos_incidence ||
        to_source.dot(to_reference) < min_cos_angle) {
      return false;
    }
    const Vector3f in_camera =
        camera.rotation * point.position + camera.translation;
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
    return std::abs(depth - in_camera.z()) < kSameDepth * in_camera.z() &&
           std::abs(HighlightIn(source, point.position, point.normal) -
                    point.highlight) < kSameHighlight;
  }

  float HighlightIn(size_t view, const Vector3f& position,
                    const Vector3f& normal) const {
    return Highlight(scene, position, normal, cameras[view].center);
  }

  PixelIndex Content(PixelIndex pixel) const;
  SurfacePoint PointAt(PixelIndex pixel, int32_t facet) const;

  // The error of a pixel's depth in deviations: two smooth parts that neighbors
  // share, and an independent part.
  float DepthNoise(int row, int col) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 10, reference));
    const float coarse = SmoothNoise(col / 17.0f, row / 17.0f, key);
    const float fine = SmoothNoise(col / 6.0f, row / 6.0f, key + 1);
    const float own = Gaussian(Hash(seed, 11, reference, row * 65536ull + col));
    const float shared = options.correlated_share;
    return std::sqrt(shared) * (0.6f * fine + 0.8f * coarse) +
           std::sqrt(1 - shared) * own;
  }

  bool DropsOut(int row, int col, float blank) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 12, reference));
    const float patch = SmoothNoise(col / 8.0f, row / 8.0f, key);
    // About one in twelve lies above 1.4 deviations.
    return patch > 1.4f - 1.6f * blank &&
           Uniform(Hash(seed, 13, reference, row * 65536ull + col)) <
               12 * options.dropout + blank;
  }

  Vector3f NoisyNormal(const Vector3f& normal, float factor, int row,
                       int col) const {
    const auto key = static_cast<uint32_t>(Hash(seed, 14, reference));
    const float scale = factor * options.normal_noise * std::numbers::pi / 180;
    const float x = col / 5.0f, y = row / 5.0f;
    return (normal + scale * Vector3f(SmoothNoise(x, y, key),
                                      SmoothNoise(x, y, key + 1),
                                      SmoothNoise(x, y, key + 2)))
        .normalized();
  }

  DepthFit FitDepth(PixelIndex pixel, const SurfacePoint& point) const;
  void MatchPixel(int row, int col, DepthMap* map) const;
};

// The pixel whose content stereo assigns to `pixel`: itself or, near a
// silhouette, one a little inside of the foreground.
PixelIndex Matcher::Content(PixelIndex pixel) const {
  const Visible& seen = visible[reference];
  const auto depth_at = [&](int row, int col) {
    const bool is_inside =
        row >= 0 && col >= 0 && row < seen.height && col < seen.width;
    const float depth = is_inside ? seen.depths[seen.Index(row, col)] : 0;
    return depth > 0 ? depth : 1e30f;
  };
  const float behind = (1 - kSilhouette) * depth_at(pixel.row, pixel.col);
  for (int step = 1; step <= options.fattening; ++step) {
    for (int i = 0; i < 9; ++i) {
      const int down = i / 3 - 1, right = i % 3 - 1;
      const float depth =
          depth_at(pixel.row + step * down, pixel.col + step * right);
      if (depth >= behind) {
        continue;
      }
      const auto key = static_cast<uint32_t>(Hash(seed, 15, reference));
      const float reach =
          0.8f * std::abs(SmoothNoise(pixel.col / 7.0f, pixel.row / 7.0f, key));
      if (step > std::min(reach, 1.0f) * options.fattening) {
        return pixel;
      }
      const PixelIndex inner = {pixel.row + (step + 2) * down,
                                pixel.col + (step + 2) * right};
      return depth_at(inner.row, inner.col) < behind
                 ? inner
                 : PixelIndex{pixel.row + step * down,
                              pixel.col + step * right};
    }
  }
  return pixel;
}

SurfacePoint Matcher::PointAt(PixelIndex pixel, int32_t facet) const {
  const Visible& seen = visible[reference];
  SurfacePoint point;
  point.depth = seen.depths[seen.Index(pixel.row, pixel.col)];
  point.position = cameras[reference].center +
                   point.depth * RayDirection(scene.views[reference],
                                              pixel.col + 0.5, pixel.row + 0.5);
  point.normal = Vector3f::Zero();
  for (const uint32_t vertex : scene.surface.facets[facet]) {
    point.normal += scene.normals[vertex];
  }
  point.normal.normalize();
  point.blank = scene.blank.At(point.position);
  point.highlight = HighlightIn(reference, point.position, point.normal);
  return point;
}

DepthFit Matcher::FitDepth(PixelIndex pixel, const SurfacePoint& point) const {
  // Where COLMAP looks for the point: on the ray of the pixel's corner.
  const Vector3f direction =
      RayDirection(scene.views[reference], pixel.col, pixel.row);
  const Vector3f start = cameras[reference].center + point.depth * direction;
  DepthFit fit;
  for (size_t source = 0; source < cameras.size(); ++source) {
    if (source == reference || !Sees(source, point)) {
      continue;
    }
    ++fit.num_sources;
    const Camera& other = cameras[source];
    const Vector3f p = other.rotation * start + other.translation;
    const Vector3f d = other.rotation * direction;
    const Vector2f slope = other.focal.cwiseProduct(
        (d.head<2>() - p.head<2>() * (d.z() / p.z())) / p.z());
    const Vector2f match = other.ImageFromCam(other.rotation * point.position +
                                              other.translation) -
                           Vector2f::Constant(0.5f);
    fit.sum_squares += slope.squaredNorm();
    fit.sum_errors += slope.dot(match - other.ImageFromCam(p));
  }
  return fit;
}

void Matcher::MatchPixel(int row, int col, DepthMap* map) const {
  const PixelIndex content = Content({row, col});
  const int32_t facet =
      visible[reference].facets[map->Index(content.row, content.col)];
  if (facet < 0) {
    return;
  }
  const SurfacePoint point = PointAt(content, facet);
  const Camera& camera = cameras[reference];
  const Vector3f to_reference = (camera.center - point.position).normalized();
  if (DropsOut(row, col, point.blank) ||
      to_reference.dot(point.normal) < min_cos_incidence) {
    return;
  }
  const DepthFit fit = FitDepth(content, point);
  if (fit.num_sources < options.min_num_sources || !(fit.sum_squares > 0)) {
    return;
  }
  const float noise = (1 + 4 * point.blank) * options.noise;
  const size_t index = map->Index(row, col);
  map->depths[index] =
      point.depth + fit.sum_errors / fit.sum_squares +
      noise / std::sqrt(fit.sum_squares) * DepthNoise(row, col);
  map->normals[index] =
      NoisyNormal(point.normal, 1 + 2 * point.blank, row, col);
}

}  // namespace

DepthMap SimulateStereo(const Scene& scene, const std::vector<Visible>& visible,
                        size_t view, const StereoOptions& options,
                        uint64_t seed) {
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
  tbb::parallel_for(0, map.height, [&](int row) {
    for (int col = 0; col < map.width; ++col) {
      matcher.MatchPixel(row, col, &map);
    }
  });
  return map;
}

}  // namespace colmap_ext::synthetic
