#pragma once

#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// Returns the colour of an error: from dark violet for none over green to
// yellow for `scale` and beyond, the colour map viridis [Smith2015],
// interpolated linearly. The colour-blind can read it, too.
// \pre scale > 0
Color ErrorColor(double error, double scale);

// Returns the end of a colour scale: the least of 1, 2 and 5 times the powers
// of ten that is no less than the 95th percentile of the errors; 1 if that is
// 0.
double ErrorScale(std::vector<double> errors);

}  // namespace colmap_ext
