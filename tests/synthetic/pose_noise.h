#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/view.h"

namespace colmap_ext::synthetic {

// Errors of a sparse model's cameras.
struct PoseNoiseOptions {
  // Approximate RMS motion of the image content, px: half of it by rotations,
  // half by translations of the camera, of zero mean.
  double pixels = 0;

  // Whether neighboring images have similar errors, as after drift.
  bool is_smooth = false;

  // Whether the depth maps are fused by the disturbed cameras, as in practice.
  bool is_before_fusion = true;

  // A factor on all focal lengths.
  double focal_factor = 1;

  // Returns what is wrong with the options, in one line; empty if nothing is.
  std::string Check() const;
};

// The views with poses and focal lengths disturbed.
// \param depth  of the scene, scene units.
std::vector<View> DisturbViews(const PoseNoiseOptions& options,
                               const std::vector<View>& views, double depth,
                               uint64_t seed);

}  // namespace colmap_ext::synthetic
