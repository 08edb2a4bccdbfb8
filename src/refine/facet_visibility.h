#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// Which views show each facet.
struct FacetVisibility {
  std::vector<uint64_t> offsets{0};  // [F + 1], into views
  std::vector<uint32_t> views;       // ascending in each row

  std::span<const uint32_t> Views(size_t facet) const {
    return {views.data() + offsets[facet], views.data() + offsets[facet + 1]};
  }
};

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
