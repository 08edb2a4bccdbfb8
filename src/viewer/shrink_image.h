#pragma once

#include "scene/color_image.h"

namespace colmap_ext {

// A picture of at most `max_size` pixels a side; each is the mean of the pixels
// that it covers. Smaller ones are returned as they are.
ColorImage ShrinkImage(ColorImage image, int max_size);

}  // namespace colmap_ext
