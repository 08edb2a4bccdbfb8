#include "pictures/mesh_renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "spatial/bvh.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

const Vector3f kBackground(1, 1, 1);
const Vector3f kFront(0.78f, 0.78f, 0.76f);
const Vector3f kBack(0.85f, 0.25f, 0.2f);
constexpr float kLineWidth = 0.8f;  // px

// Far apart for labels that follow each other: the R3 sequence of Roberts, "The
// unreasonable effectiveness of quasirandom sequences" (2018).
Vector3f BaseOfLabel(int32_t label) {
  if (label < 0) {
    return kFront;
  }
  constexpr double kSteps[] = {0.8191725134, 0.6710436067, 0.5497004779};
  Vector3f color;
  for (int i = 0; i < 3; ++i) {
    const double t = kSteps[i] * (label + 1.0);
    color[i] = static_cast<float>(0.25 + 0.7 * (t - std::floor(t)));
  }
  return color;
}

// For each facet the smallest vertex of those it is connected with.
std::vector<int32_t> Components(const TriangleMesh& mesh) {
  std::vector<uint32_t> parents(mesh.vertices.size());
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](uint32_t vertex) {
    while (parents[vertex] != vertex) {
      vertex = parents[vertex] = parents[parents[vertex]];
    }
    return vertex;
  };
  for (const Facet& facet : mesh.facets) {
    for (int i = 1; i < 3; ++i) {
      const auto [low, high] = std::minmax({root(facet[0]), root(facet[i])});
      parents[high] = low;
    }
  }
  std::vector<int32_t> components;
  for (const Facet& facet : mesh.facets) {
    components.push_back(static_cast<int32_t>(root(facet[0])));
  }
  return components;
}

class Renderer {
 public:
  Renderer(const DrawnMesh& drawn, const View& view, RenderMode mode)
      : drawn_(drawn), view_(view), mode_(mode), bvh_(drawn.mesh) {
    if (mode == RenderMode::kLabels) {
      labels_ = drawn.labels.empty() ? Components(drawn.mesh) : drawn.labels;
    }
    eye_ = view.Center().cast<float>();
    // From above and to the left of the camera.
    sun_ = (view.cam_from_world_rotation.transpose() *
            Eigen::Vector3d(-0.5, -0.6, -0.7).normalized())
               .cast<float>();
  }

  Vector3f Pixel(int row, int col) const {
    RayPacket rays;
    rays.origin = eye_;
    for (int i = 0; i < 4; ++i) {
      const int sub_row = i / 2;
      const int sub_col = i % 2;
      rays.SetDirection(i, RayDirection(view_, col + 0.25 + 0.5 * sub_col,
                                        row + 0.25 + 0.5 * sub_row));
    }
    const HitPacket hits = bvh_.Intersect(rays);
    Vector3f sum = Vector3f::Zero();
    for (int i = 0; i < 4; ++i) {
      sum += hits.facet[i] < 0
                 ? kBackground
                 : Shade(hits.facet[i], hits.distance[i],
                         Vector3f(rays.x[i], rays.y[i], rays.z[i]));
    }
    return sum / 4;
  }

  float Light(const Vector3f& normal, const Vector3f& direction) const {
    return 0.12f + 0.63f * std::max(0.0f, normal.dot(sun_)) +
           0.25f * std::abs(normal.dot(direction.normalized()));
  }

 private:
  Vector3f Shade(int32_t index, float depth, const Vector3f& direction) const {
    const Facet& facet = drawn_.mesh.facets[index];
    const Vector3f& a = drawn_.mesh.vertices[facet[0]];
    const Vector3f& b = drawn_.mesh.vertices[facet[1]];
    const Vector3f& c = drawn_.mesh.vertices[facet[2]];
    const Vector3f cross = (b - a).cross(c - a);
    const Vector3f normal = cross.normalized();
    const bool is_back = normal.dot(direction) > 0;
    const Vector3f point = eye_ + depth * direction;
    // Twice the areas that the point has opposite of each corner.
    const Vector3f areas((b - point).cross(c - point).dot(normal),
                         (c - point).cross(a - point).dot(normal),
                         (a - point).cross(b - point).dot(normal));
    Vector3f base = is_back ? kBack : kFront;
    if (mode_ == RenderMode::kNormals && !is_back) {
      return 0.5f * (normal + Vector3f::Ones());
    }
    if (mode_ == RenderMode::kColor && !is_back && !drawn_.colors.empty()) {
      base.setZero();
      for (int i = 0; i < 3; ++i) {
        const Color& color = drawn_.colors[facet[i]];
        base += areas[i] / areas.sum() / 255 *
                Vector3f(color[0], color[1], color[2]);
      }
      return base;
    }
    if (mode_ == RenderMode::kLabels && !is_back) {
      base = BaseOfLabel(labels_[index]);
    }
    const float light = Light(is_back ? Vector3f(-normal) : normal, direction);
    if (mode_ == RenderMode::kWireframe) {
      const Vector3f heights(areas[0] / (c - b).norm(),
                             areas[1] / (a - c).norm(),
                             areas[2] / (b - a).norm());
      const float pixel = depth / static_cast<float>(view_.fx);
      if (heights.minCoeff() < 0.5f * kLineWidth * pixel) {
        return Vector3f(0.1f, 0.15f, 0.3f);
      }
    }
    return base * light;
  }

  const DrawnMesh& drawn_;
  const View& view_;
  const RenderMode mode_;
  const Bvh bvh_;
  std::vector<int32_t> labels_;
  Vector3f eye_, sun_;
};

Color ToColor(const Vector3f& value) {
  Color color;
  for (int i = 0; i < 3; ++i) {
    color[i] = static_cast<uint8_t>(
        std::lround(255 * std::clamp(value[i], 0.0f, 1.0f)));
  }
  return color;
}

// The points as discs in a depth buffer of the picture's size.
void DrawPoints(const DrawnMesh& drawn, const View& view,
                const Renderer& renderer, double radius, ColorImage* image) {
  std::vector<float> depths(image->pixels.size(), 1e30f);
  for (size_t p = 0; p < drawn.mesh.vertices.size(); ++p) {
    const Vector3f& point = drawn.mesh.vertices[p];
    const Eigen::Vector3d in_camera = view.CamFromWorld(point.cast<double>());
    if (!(in_camera.z() > 0)) {
      continue;
    }
    const Eigen::Vector2d at = view.ImageFromCam(in_camera);
    if (!(at.cwiseAbs().maxCoeff() < 1e6)) {
      continue;
    }
    Vector3f color = kFront;
    if (!drawn.colors.empty()) {
      color =
          Vector3f(drawn.colors[p][0], drawn.colors[p][1], drawn.colors[p][2]) /
          255;
    } else if (!drawn.normals.empty()) {
      color *=
          renderer.Light(drawn.normals[p], point - view.Center().cast<float>());
    }
    const int first_row = std::max(0.0, std::ceil(at.y() - radius - 0.5));
    const int first_col = std::max(0.0, std::ceil(at.x() - radius - 0.5));
    for (int row = first_row;
         row < image->height && row + 0.5 <= at.y() + radius; ++row) {
      for (int col = first_col;
           col < image->width && col + 0.5 <= at.x() + radius; ++col) {
        const size_t index = static_cast<size_t>(row) * image->width + col;
        if (std::hypot(col + 0.5 - at.x(), row + 0.5 - at.y()) <= radius &&
            in_camera.z() < depths[index]) {
          depths[index] = in_camera.z();
          image->pixels[index] = ToColor(color);
        }
      }
    }
  }
}

}  // namespace

Color LabelColor(int32_t label) { return ToColor(BaseOfLabel(label)); }

ColorImage RenderMesh(const DrawnMesh& drawn, const View& view, RenderMode mode,
                      double point_radius) {
  ColorImage image;
  image.width = view.width;
  image.height = view.height;
  image.pixels.resize(static_cast<size_t>(view.width) * view.height,
                      ToColor(kBackground));
  const Renderer renderer(drawn, view, mode);
  if (drawn.mesh.facets.empty()) {
    DrawPoints(drawn, view, renderer, point_radius, &image);
    return image;
  }
  tbb::parallel_for(0, view.height, [&](int row) {
    for (int col = 0; col < view.width; ++col) {
      image.pixels[static_cast<size_t>(row) * view.width + col] =
          ToColor(renderer.Pixel(row, col));
    }
  });
  return image;
}

}  // namespace colmap_ext
