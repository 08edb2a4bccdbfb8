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
  // and knobs, with cameras on an arc before it. "grid": a lattice of thin
  // rods, and blades, in front of a backdrop that they hide in part, with the
  // same cameras.
  std::string shape = "statue";

  // The number of cameras.
  int num_images = 12;

  // The size of the images, px.
  int width = 640;
  int height = 480;

  // The height of the fine relief, as a factor of the default's.
  double relief = 1.0;

  // The thickness of the grid's rods and blades, as a factor of the default's.
  double thickness = 1.0;

  // How much a patch of the surface lacks texture and relief, [0, 1]. Stereo
  // leaves holes and noise there.
  double untextured = 0.0;

  // The intensity of highlights on another patch, [0, 2]. Where one differs
  // between two images, they are not matched.
  double gloss = 0.0;

  // The largest change of the exposure from one image to another, as a share
  // of its mean.
  double exposure_change = 0.1;

  // The edge of the lattice cells that the true surface is made of, in pixels
  // of the images; its facets have edges of about two thirds of that.
  double cell_size = 3.5;

  // Seed of everything random: surface, texture, cameras, exposures, noise.
  uint64_t seed = 1;

  // The number of threads to use. Default is all threads. The result does not
  // depend on it.
  int num_threads = -1;
};

// A part of the surface: inside of a ball, faded out at its border.
struct Patch {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0;    // scene units
  float strength = 0;  // of the patch's property

  // `strength` inside, 0 outside.
  float At(const Eigen::Vector3f& point) const;
};

// A scene with known geometry and light. About 2 scene units across, z is up.
struct Scene {
  TriangleMesh surface;                  // the truth, facets seen from outside
  std::vector<Eigen::Vector3f> normals;  // [V], unit, to the outside
  std::vector<float> irradiance;  // [V], light that arrives, shadows included
  std::vector<View> views;        // exact
  std::vector<double> exposures;  // [views], factor on the image's intensity
  Eigen::Vector3f to_sun = Eigen::Vector3f::UnitZ();  // unit
  Patch blank;                                        // lacks texture
  Patch shiny;                                        // has highlights
  float footprint = 0;  // of a pixel on the surface, scene units
  uint32_t texture_seed = 0;
};

// The properties of a kind of scene.
struct SceneShape {
  std::string name;
  Solid (*make_solid)(const SceneOptions& options);
  std::vector<View> (*make_views)(const SceneOptions& options);
  Eigen::Vector3f to_sun;  // any length
  Patch blank;             // of SceneOptions::untextured
  Patch shiny;             // of SceneOptions::gloss
};

// Returns nullptr for an unknown name.
const SceneShape* FindSceneShape(const std::string& name);

// \throw std::invalid_argument for an unknown shape.
Scene MakeScene(const SceneOptions& options);

// Share of the light that the surface reflects in red, green and blue, [0, 1]:
// a solid texture with detail down to about a pixel.
Eigen::Vector3f Albedo(const Scene& scene, const Eigen::Vector3f& point);

// The highlight that is seen at a point of the surface in full sun from `eye`
// [Blinn1977], 1 for the light of a white surface.
float Highlight(const Scene& scene, const Eigen::Vector3f& point,
                const Eigen::Vector3f& normal, const Eigen::Vector3f& eye);

}  // namespace colmap_ext::synthetic
