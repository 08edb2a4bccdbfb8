#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "raster/facet_visibility.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns [F] the area that each facet covers in the images, px^2: the second
// largest over the views that see it, as two views are needed to refine it; 0
// where fewer than two do.
std::vector<float> RefinableAreas(const TriangleMesh& mesh,
                                  const std::vector<View>& views,
                                  const FacetVisibility& visibility);

}  // namespace colmap_ext
