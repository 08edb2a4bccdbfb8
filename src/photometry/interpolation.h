#pragma once

#include "scene/gray_image.h"

namespace colmap_ext {

// An image between its pixels' centres, and its gradient.
struct Interpolated {
  float value = 0;  // grey value
  float by_u = 0;   // grey values / px
  float by_v = 0;   // grey values / px
};

// Bicubic [Catmull1974]: what bilinear interpolation blurs, the correlation
// would miss. Beyond the border the image goes on as its last pixel.
// \param u, v  pixel coordinates, px, see View.
// \pre (u, v) is not outside of the border pixels' centres
Interpolated Interpolate(const GrayImage& image, double u, double v);

}  // namespace colmap_ext
