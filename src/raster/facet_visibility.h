#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// The views that show each facet, ascending: [F].
using FacetVisibility = Rows<uint32_t>;

struct FacetVisibilityOptions {
  // Between the facet's normal and the ray to the camera.
  double min_cosine = 0.1;

  // Pixels that a facet's centre has to keep from the image's border.
  double border = 3;
};

// Draws the mesh into all views and looks for each facet's centroid: it is seen
// where nothing is drawn in front of it, the facet faces the camera, and is not
// at the image's border.
FacetVisibility FindVisibleFacets(const FacetVisibilityOptions& options,
                                  const TriangleMesh& mesh,
                                  const std::vector<View>& views);

}  // namespace colmap_ext
