#include "pictures/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/percentile.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Colors and light are chosen by eye.
const Vector3f kBackground(1, 1, 1);
const Vector3f kPlain(0.78f, 0.78f, 0.76f);
const Vector3f kBack(0.85f, 0.25f, 0.2f);

Vector3f LabelBase(int32_t label) {
  if (label < 0) {
    return kPlain;
  }
  constexpr double kSteps[] = {0.8191725134, 0.6710436067, 0.5497004779};
  Vector3f color;
  for (int i = 0; i < 3; ++i) {
    const double t = kSteps[i] * (label + 1.0);
    color[i] = static_cast<float>(0.25 + 0.7 * (t - std::floor(t)));
  }
  return color;
}

Color ToColor(const Vector3f& value) {
  Color color;
  for (int i = 0; i < 3; ++i) {
    color[i] = static_cast<uint8_t>(
        std::lround(255 * std::clamp(value[i], 0.0f, 1.0f)));
  }
  return color;
}

// Casts the rays of a camera.
class RayCaster {
 public:
  RayCaster(const TriangleMesh& mesh, const Bvh& bvh, const View& view)
      : mesh_(mesh), bvh_(bvh), view_(view) {}

  // For each coloring, the mean of rays through the centers of the pixel's
  // quarters.
  std::vector<Vector3f> Pixel(int row, int col,
                              const std::vector<FrontColor>& colors) const {
    RayPacket rays;
    rays.origin = eye_;
    for (int i = 0; i < 4; ++i) {
      rays.SetDirection(i, RayDirection(view_, col + 0.25 + 0.5 * (i % 2),
                                        row + 0.25 + 0.5 * (i >> 1)));
    }
    const HitPacket hits = bvh_.Intersect(rays);
    std::vector<Vector3f> means(colors.size(), Vector3f::Zero());
    for (int i = 0; i < 4; ++i) {
      const Vector3f direction(rays.x[i], rays.y[i], rays.z[i]);
      for (size_t j = 0; j < colors.size(); ++j) {
        means[j] += (hits.facet[i] < 0 ? kBackground
                                       : Shade(hits.facet[i], hits.distance[i],
                                               direction, colors[j])) /
                    4;
      }
    }
    return means;
  }

 private:
  float Light(const Vector3f& normal, const Vector3f& direction) const {
    return 0.12f + 0.63f * std::max(0.0f, normal.dot(sun_)) +
           0.25f * std::abs(normal.dot(direction.normalized()));
  }

  Vector3f Shade(int32_t index, float depth, const Vector3f& direction,
                 const FrontColor& front_color) const {
    const auto [a, b, c] = CornersOf(mesh_, mesh_.facets[index]);
    const Vector3f normal = (b - a).cross(c - a).normalized();
    if (normal.dot(direction) > 0) {
      return kBack * Light(-normal, direction);
    }
    const Vector3f point = eye_ + depth * direction;
    const Vector3f areas((b - point).cross(c - point).dot(normal),
                         (c - point).cross(a - point).dot(normal),
                         (a - point).cross(b - point).dot(normal));
    return front_color(
        {static_cast<uint32_t>(index), areas, Light(normal, direction)});
  }

  const TriangleMesh& mesh_;
  const Bvh& bvh_;
  const View& view_;
  const Vector3f eye_ = view_.Center().cast<float>();
  const Vector3f sun_ = SunDirection(view_);
};

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
  Ball ball{MedianPoint(points), 0};
  std::vector<double> values(points.size());
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

Vector3f SunDirection(const View& view) {
  return (view.cam_from_world_rotation.transpose() *
          Vector3d(-0.5, -0.6, -0.7).normalized())
      .cast<float>();
}

std::vector<ColorImage> MeshRenderer::Draw(
    const View& view, const std::vector<FrontColor>& colors) const {
  const ColorImage blank{
      view.width, view.height,
      std::vector<Color>(static_cast<size_t>(view.width) * view.height)};
  std::vector<ColorImage> images(colors.size(), blank);
  const RayCaster ray_caster(mesh_, bvh_, view);
  tbb::parallel_for(0, view.height, [&](int row) {
    for (int col = 0; col < view.width; ++col) {
      const std::vector<Vector3f> values = ray_caster.Pixel(row, col, colors);
      for (size_t i = 0; i < images.size(); ++i) {
        images[i].pixels[static_cast<size_t>(row) * view.width + col] =
            ToColor(values[i]);
      }
    }
  });
  return images;
}

FrontColor VertexColors(const TriangleMesh& mesh,
                        const std::vector<Color>& colors, float shade) {
  return [&mesh, &colors, shade](const FrontHit& hit) {
    Vector3f mean = Vector3f::Zero();
    for (int i = 0; i < 3; ++i) {
      const Color& color = colors[mesh.facets[hit.facet][i]];
      mean += hit.areas[i] / hit.areas.sum() / 255 *
              Vector3f(color[0], color[1], color[2]);
    }
    return Vector3f(mean * (1 - shade + shade * hit.light));
  };
}

FrontColor LabelColors(const std::vector<int32_t>& labels) {
  return [&labels](const FrontHit& hit) {
    return Vector3f(LabelBase(labels[hit.facet]) * hit.light);
  };
}

FrontColor PlainColor() {
  return [](const FrontHit& hit) { return Vector3f(kPlain * hit.light); };
}

ColorImage RenderMesh(const TriangleMesh& mesh, const View& view,
                      const FrontColor& front_color) {
  return MeshRenderer(mesh).Draw(view, {front_color})[0];
}

Color LabelColor(int32_t label) { return ToColor(LabelBase(label)); }

Vector3d MedianPoint(const std::vector<Vector3f>& points) {
  Vector3d median = Vector3d::Zero();
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::ranges::transform(points, values.begin(),
                           [axis](const auto& point) { return point[axis]; });
    median[axis] = Median(&values);
  }
  return median;
}

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
  const auto most = std::ranges::max_element(num_seen);
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
    const auto farthest = std::ranges::max_element(distances);
    if (*farthest == 0) {
      break;
    }
    chosen.push_back(farthest - distances.begin());
  }
  return chosen;
}

}  // namespace colmap_ext
