#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "scene/images.h"

namespace colmap_ext::synthetic {

// Effects of a camera and its software on an image, in the order in which they
// are applied.
struct CameraOptions {
  // Standard deviation of the Gaussian lens blur, px. Each image has 0.5 to 1.5
  // times this value.
  double defocus = 0;

  // Share of the light lost at the corners. The loss grows with the squared
  // distance from the image's center.
  double vignetting = 0;

  // Standard deviation of the sensor noise in the dark, in steps of 1/255.
  double sensor_noise = 1.5;

  // Standard deviation of the photon noise at full intensity, in steps of
  // 1/255.
  double photon_noise = 2.0;

  // Whether each pixel measures one color of a Bayer pattern and the others are
  // interpolated, which correlates the noise of neighboring pixels.
  bool has_mosaic = false;

  // Weight of the unsharp mask (radius 1 px). Each image has 0.5 to 1.5 times
  // this value.
  double sharpening = 0;

  // Quality of the JPEG compression, 1 ... 100; 0: lossless.
  int jpeg_quality = 0;
};

// Light that reaches the lens: red, green and blue, 1 at full intensity.
using RadianceImage = Image<Eigen::Vector3f>;

// Returns the 8-bit image that a camera makes of this light.
// \param hash  seed of the image's noise
// \pre width and height are positive
ColorImage TakePhotograph(const RadianceImage& radiance,
                          const CameraOptions& options, uint64_t hash);

}  // namespace colmap_ext::synthetic
