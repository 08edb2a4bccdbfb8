#pragma once

#include "scene/color_image.h"

namespace colmap_ext {

// Returns a picture at another size; where it gets smaller each pixel is the
// mean of those it covers.
// \pre all sizes are positive
ColorImage ResizePicture(const ColorImage& image, int width, int height);

}  // namespace colmap_ext
