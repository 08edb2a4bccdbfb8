#pragma once

#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// Colour of an error: from dark violet for none over green to yellow for
// `scale` and beyond (the colour map viridis of Smith and van der Walt, sampled
// and interpolated linearly), which is read alike by the colour-blind.
// \pre scale > 0
Color ErrorColor(double error, double scale);

// A round number, 1, 2 or 5 times a power of ten, that 95 % of the errors are
// below, to be the end of a colour scale; 1 if there are no errors but zeros.
double ErrorScale(std::vector<double> errors);

}  // namespace colmap_ext
