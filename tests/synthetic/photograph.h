#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "scene/images.h"

namespace colmap_ext::synthetic {

// What a camera and its software do to a picture, in this order.
struct CameraOptions {
  // Deviation of the Gaussian that the lens blurs by, px. An image has between
  // half and one and a half of it.
  double defocus = 0;

  // Share of the light that the corners lack; it grows as the square of the
  // distance from the image's center.
  double vignetting = 0;

  // Deviation of the sensor's noise in the dark, in steps of 1/255.
  double sensor_noise = 1.5;

  // Deviation of the photon noise at full intensity, in steps of 1/255.
  double photon_noise = 2.0;

  // Whether the sensor has one color per pixel, in Bayer's pattern, and the
  // others are interpolated. Their noise is alike in neighboring pixels then.
  bool has_mosaic = false;

  // Weight of the difference from a picture blurred by 1 px that is added. An
  // image has between half and one and a half of it.
  double sharpening = 0;

  // Of the JPEG file that the image is kept as, 1 ... 100; 0: without loss.
  int jpeg_quality = 0;
};

// Light that reaches the lens: red, green and blue, 1 at full intensity.
using RadianceImage = Image<Eigen::Vector3f>;

// \param hash  of the image; all noise follows from it.
// \pre width and height are positive
ColorImage TakePhotograph(const RadianceImage& radiance,
                          const CameraOptions& options, uint64_t hash);

}  // namespace colmap_ext::synthetic
