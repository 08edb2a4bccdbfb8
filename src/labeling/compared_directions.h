#pragma once

#include <vector>

#include "labeling/facet_labels.h"
#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// The same labels, each compared in one direction only: in the view that shows
// the facet smaller. The other view's samples lie at least a pixel apart then;
// the other way round, one pixel of the smaller view would count several times
// (docs/method.md, section 7.3).
// \param views  of any level
FacetLabels InSmallerView(FacetLabels labels, const TriangleMesh& mesh,
                          const std::vector<View>& views);

}  // namespace colmap_ext
