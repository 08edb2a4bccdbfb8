#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Draws a mesh in the colours of its vertices' errors, above the scale of the
// colours, which ends at `scale`, scene units. What is seen from behind is red.
ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale);

}  // namespace colmap_ext
