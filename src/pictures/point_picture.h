#pragma once

#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Draws points as squares of `side` px, the nearest on top. Points without
// colours are grey, where there is none it is white.
// \pre side > 0
ColorImage DrawPoints(const PointCloud& cloud, const View& view, int side);

}  // namespace colmap_ext
