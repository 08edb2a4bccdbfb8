#include "tests/synthetic/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "spatial/bvh.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3f;

constexpr int kNumSkyRays = 8;  // a multiple of four
// More rays without texture, so that their noise does not look like one.
constexpr int kNumBlankSkyRays = 64;
constexpr float kSky = 0.45f;  // fraction of the light from the sky
constexpr float kSkyReach =
    0.6f;  // scene units; occluders farther away are ignored

// Direction of the sky's k-th of num_rays rays at a point, distributed by the
// cosine around the normal.
Vector3f SkyDirection(const Vector3f& normal, uint64_t hash, int k,
                      int num_rays) {
  const double height = 2 * (k + Uniform(hash)) / num_rays - 1;
  const double turn = 6.283185307 * (0.618034 * k + Uniform(hash ^ 1));
  const double radius = std::sqrt(1 - height * height);
  const Vector3f on_sphere(radius * std::cos(turn), radius * std::sin(turn),
                           height);
  return (normal + 0.99f * on_sphere).normalized();
}

// Light at a vertex: sun with soft shadows, and the visible part of the sky.
float Irradiance(const Scene& scene, const Bvh& bvh, size_t vertex,
                 uint64_t hash) {
  const Vector3f& point = scene.surface.vertices[vertex];
  const Vector3f& normal = scene.normals[vertex];
  RayPacket rays;
  rays.origin = point + 0.5f * scene.footprint * normal;
  int num_sun = 0;
  for (int i = 0; i < 4; ++i) {
    const Vector3f jitter(Uniform(Hash(hash, i, 0)), Uniform(Hash(hash, i, 1)),
                          Uniform(Hash(hash, i, 2)));
    rays.SetDirection(
        i, scene.to_sun + 0.06f * (jitter - Vector3f::Constant(0.5f)));
  }
  const Int4 sun_hit = bvh.Intersect(rays).facet;
  for (int i = 0; i < 4; ++i) {
    num_sun += sun_hit[i] < 0;
  }
  const int num_rays =
      scene.blank.At(point) > 0 ? kNumBlankSkyRays : kNumSkyRays;
  int num_sky = 0;
  rays.max_distance = kSkyReach;
  for (int k = 0; k < num_rays; k += 4) {
    for (int i = 0; i < 4; ++i) {
      rays.SetDirection(i, SkyDirection(normal, hash, k + i, num_rays));
    }
    const Int4 sky_hit = bvh.Intersect(rays).facet;
    for (int i = 0; i < 4; ++i) {
      num_sky += sky_hit[i] < 0;
    }
  }
  const float cosine = std::max(0.0f, scene.to_sun.dot(normal));
  return kSky * num_sky / num_rays + (1 - kSky) * cosine * num_sun / 4;
}

std::vector<float> AllIrradiance(const Scene& scene, uint64_t seed) {
  const Bvh bvh(scene.surface);
  std::vector<float> irradiance(scene.surface.vertices.size());
  tbb::parallel_for(size_t{0}, irradiance.size(), [&](size_t v) {
    irradiance[v] = Irradiance(scene, bvh, v, Hash(seed, 3, v));
  });
  return irradiance;
}

// The solid of the shape, without relief where it is blank.
Solid SolidOf(const SceneShape& shape, const SceneOptions& options,
              const Patch& blank) {
  Solid solid = shape.make_solid(options);
  if (blank.strength > 0) {
    solid.detail = [relief = solid.detail, blank](const Vector3f& point) {
      return (1 - blank.At(point)) * relief(point);
    };
  }
  return solid;
}

}  // namespace

float Patch::At(const Vector3f& point) const {
  const float border = 4 * (1 - (point - center).norm() / radius);
  return strength > 0 ? strength * std::clamp(border, 0.0f, 1.0f) : 0;
}

Scene MakeScene(const SceneOptions& options) {
  const SceneShape* found = FindSceneShape(options.shape);
  if (found == nullptr) {
    throw std::invalid_argument("scene must be `statue`, `wall` or `grid`");
  }
  const SceneShape& shape = *found;
  Scene scene;
  scene.views = shape.make_views(options);
  double distance = 0;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "%04d.png", static_cast<int>(i));
    scene.views[i].name = name;
    scene.exposures.push_back(1 +
                              options.exposure_change *
                                  (2 * Uniform(Hash(options.seed, 4, i)) - 1));
    distance += scene.views[i].Center().norm() / scene.views.size();
  }
  scene.footprint = distance / scene.views[0].fx;
  scene.texture_seed = Hash(options.seed, 5);
  scene.to_sun = shape.to_sun.normalized();
  scene.blank = shape.blank;
  scene.blank.strength = static_cast<float>(options.untextured);
  scene.shiny = shape.shiny;
  scene.shiny.strength = static_cast<float>(options.gloss);
  scene.surface = MeshSolid(SolidOf(shape, options, scene.blank),
                            options.cell_size * scene.footprint);
  scene.normals = VertexNormals(scene.surface);
  scene.irradiance = AllIrradiance(scene, options.seed);
  return scene;
}

Vector3f Albedo(const Scene& scene, const Vector3f& point) {
  // The first octave has three cells per unit, the last one or two pixels.
  constexpr float kFirst = 3.0f;
  const Vector3f kBlank(0.62f, 0.60f, 0.56f);
  const int num_octaves = std::clamp(
      static_cast<int>(std::log(1 / (1.6f * kFirst * scene.footprint)) /
                       std::log(1.9f)) +
          1,
      2, 10);
  const uint32_t seed = scene.texture_seed;
  const float gray =
      0.50f + 0.14f * FractalNoise(kFirst * point, num_octaves, 0.84f, seed);
  const float warm = FractalNoise(4.0f * point, 2, 0.8f, seed + 100);
  const float green = FractalNoise(5.0f * point, 2, 0.7f, seed + 200);
  const float blank = scene.blank.At(point);
  const Vector3f tint(1 + 0.11f * warm, 1 + 0.08f * green, 1 - 0.13f * warm);
  return ((1 - blank) * gray * tint + blank * kBlank)
      .cwiseMax(0.03f)
      .cwiseMin(1.0f);
}

float Highlight(const Scene& scene, const Vector3f& point,
                const Vector3f& normal, const Vector3f& eye) {
  constexpr float kShininess = 24;
  const float strength = scene.shiny.At(point);
  if (strength <= 0) {
    return 0;
  }
  const Vector3f half =
      (scene.to_sun + (eye - point).normalized()).normalized();
  return strength * std::pow(std::max(normal.dot(half), 0.0f), kShininess);
}

}  // namespace colmap_ext::synthetic
