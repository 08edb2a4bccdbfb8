#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"
#include "tests/synthetic/isosurface.h"

namespace colmap_ext::synthetic {

struct SceneOptions {
  // "statue": a ring, a head and a foot in one piece, of genus 1, on rough
  // ground, with cameras all around it. "wall": a facade with columns, niches
  // and knobs, with cameras on an arc before it.
  std::string shape = "statue";

  // The number of cameras.
  int num_images = 12;

  // The size of the images, px.
  int width = 640;
  int height = 480;

  // The height of the fine relief, as a factor of the default's.
  double relief = 1.0;

  // The edge of the lattice cells that the true surface is made of, in pixels
  // of the images; its facets have edges of about two thirds of that.
  double cell_size = 3.5;

  // Of everything random: surface, texture, cameras, exposures, noise.
  uint64_t seed = 1;

  // The number of threads to use. Default is all threads. The result does not
  // depend on it.
  int num_threads = -1;

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// A world of which everything is known. About 2 scene units across, z is up.
struct Scene {
  TriangleMesh surface;                  // the truth, facets seen from outside
  std::vector<Eigen::Vector3f> normals;  // [V], unit, to the outside
  std::vector<float> irradiance;  // [V], light that arrives, shadows included
  std::vector<View> views;        // exact
  std::vector<double> exposures;  // [views], factor on the image's intensity
  float footprint = 0;            // of a pixel on the surface, scene units
  uint32_t texture_seed = 0;
};

// \throw std::invalid_argument for options that do not check.
Scene MakeScene(const SceneOptions& options);

// Share of the light that the surface reflects in red, green and blue, [0, 1]:
// a solid texture with detail down to about a pixel.
Eigen::Vector3f Albedo(const Scene& scene, const Eigen::Vector3f& point);

// The solids and cameras of the two scenes; see scene_shapes.cc.
Solid MakeStatue(const SceneOptions& options);
Solid MakeWall(const SceneOptions& options);
std::vector<View> MakeStatueViews(const SceneOptions& options);
std::vector<View> MakeWallViews(const SceneOptions& options);

}  // namespace colmap_ext::synthetic
