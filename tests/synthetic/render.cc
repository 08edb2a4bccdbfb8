#include "tests/synthetic/dense_scene.h"

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "evaluation/mesh_evaluation.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

const Vector3f kBackground(0.16f, 0.17f, 0.19f);

// Weights of a facet's vertices at a point of its plane; they add up to one.
Vector3f Barycentric(const TriangleMesh& mesh, const Facet& facet,
                     const Vector3f& point) {
  const Vector3f& a = mesh.vertices[facet[0]];
  const Vector3f ab = mesh.vertices[facet[1]] - a;
  const Vector3f ac = mesh.vertices[facet[2]] - a;
  const Vector3f normal = ab.cross(ac);
  const float scale = 1 / normal.squaredNorm();
  const float v = (point - a).cross(ac).dot(normal) * scale;
  const float w = ab.cross(point - a).dot(normal) * scale;
  return {1 - v - w, v, w};
}

// Light that a ray brings to the camera, 1 for a white surface in full light.
Vector3f Radiance(const Scene& scene, const Vector3f& eye,
                  const Vector3f& point, int32_t facet) {
  const Facet& vertices = scene.surface.facets[facet];
  const Vector3f weights = Barycentric(scene.surface, vertices, point);
  float irradiance = 0;
  Vector3f normal = Vector3f::Zero();
  for (int i = 0; i < 3; ++i) {
    irradiance += weights[i] * scene.irradiance[vertices[i]];
    normal += weights[i] * scene.normals[vertices[i]];
  }
  const float highlight =
      irradiance * Highlight(scene, point, normal.normalized(), eye);
  return Albedo(scene, point) * (0.12f + 1.1f * irradiance) +
         Vector3f::Constant(highlight);
}

// Mean over 2 x 2 rays through a pixel.
Vector3f PixelRadiance(const Scene& scene, const Bvh& bvh, const View& view,
                       const Vector3f& eye, int row, int col) {
  RayPacket rays;
  rays.origin = eye;
  for (int i = 0; i < 4; ++i) {
    const int right = i % 2, down = i / 2;
    rays.SetDirection(i, RayDirection(view, col + 0.25 + 0.5 * right,
                                      row + 0.25 + 0.5 * down));
  }
  const HitPacket hits = bvh.Intersect(rays);
  Vector3f sum = Vector3f::Zero();
  for (int i = 0; i < 4; ++i) {
    if (hits.facet[i] < 0) {
      sum += kBackground;
      continue;
    }
    const Vector3f direction(rays.x[i], rays.y[i], rays.z[i]);
    sum +=
        Radiance(scene, eye, eye + hits.distance[i] * direction, hits.facet[i]);
  }
  return sum / 4;
}

}  // namespace

Visible RenderVisible(const Bvh& bvh, const View& view) {
  Visible visible;
  static_cast<colmap_ext::DepthMap&>(visible) =
      RenderDepths(bvh, view, 1, &visible.facets);
  return visible;
}

ColorImage RenderImage(const Scene& scene, const Bvh& bvh, size_t view_index,
                       const CameraOptions& options, uint64_t seed) {
  const View& view = scene.views[view_index];
  const auto exposure = static_cast<float>(scene.exposures[view_index]);
  RadianceImage image;
  image.width = view.width;
  image.height = view.height;
  image.pixels.resize(static_cast<size_t>(view.width) * view.height);
  const Vector3f eye = view.Center().cast<float>();
  tbb::parallel_for(0, view.height, [&](int row) {
    for (int col = 0; col < view.width; ++col) {
      image.pixels[static_cast<size_t>(row) * view.width + col] =
          exposure * PixelRadiance(scene, bvh, view, eye, row, col);
    }
  });
  return TakePhotograph(image, options, Hash(seed, 6, view_index));
}

}  // namespace colmap_ext::synthetic
