#pragma once

#include <cstdint>
#include <vector>

#include "scene/color_image.h"
#include "scene/depth_map.h"
#include "scene/view.h"
#include "spatial/bvh.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

struct RenderOptions {
  // Deviation of the sensor's noise in the dark, in steps of 1/255.
  double sensor_noise = 1.5;

  // Deviation of the photon noise at full intensity, in steps of 1/255.
  double photon_noise = 2.0;
};

// The surface at the pixel centers (col + 0.5, row + 0.5) of an image.
struct Visible : colmap_ext::DepthMap {
  std::vector<int32_t> facets;  // [height * width]; -1 for background
};

// Casts a ray through every pixel's center.
Visible RenderVisible(const Bvh& bvh, const View& view);

// Photograph of the scene by one of its views: 2 x 2 rays a pixel, diffuse
// light and highlights, exposure, noise.
ColorImage RenderImage(const Scene& scene, const Bvh& bvh, size_t view,
                       const RenderOptions& options, uint64_t seed);

}  // namespace colmap_ext::synthetic
