#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/color_image.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Draws a mesh in the colours of its vertices' errors, ErrorColor(), above the
// scale of the colours, which is 70 px high. Facets seen from behind are red.
// \param colors  [V]
// \param scale  error at the end of the scale, scene units
ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale);

}  // namespace colmap_ext
