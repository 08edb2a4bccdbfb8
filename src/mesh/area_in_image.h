#pragma once

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns the area that a facet covers in a view's image, px^2, wherever it
// ends and whatever lies before it. Of a facet that reaches behind the camera
// the part within the image counts.
double AreaInImage(const TriangleMesh& mesh, const Facet& facet,
                   const View& view);

}  // namespace colmap_ext
