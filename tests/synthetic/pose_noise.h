#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/view.h"

namespace colmap_ext::synthetic {

// How a sparse model's cameras are off.
struct PoseNoiseOptions {
  // RMS over the images of how far what they see moves, px, about: half of it
  // by turns, half by motions of the camera, of zero mean.
  double pixels = 0;

  // Whether neighboring images are off alike, as after a drift.
  bool is_smooth = false;

  // Whether the depth maps are fused by the disturbed cameras, as in life.
  bool is_before_fusion = true;

  // A factor on all focal lengths.
  double focal_factor = 1;

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// The views with poses and focal lengths disturbed.
// \param depth  at which the scene lies, scene units.
std::vector<View> DisturbViews(const PoseNoiseOptions& options,
                               const std::vector<View>& views, double depth,
                               uint64_t seed);

}  // namespace colmap_ext::synthetic
