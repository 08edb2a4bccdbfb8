#pragma once

#include <cstddef>
#include <vector>

#include "labeling/facet_labels.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// For each view the pairs with the views that it shares the most points with
// (L_simpl of the paper, section 5): each pair once, ascending. Ties go to the
// lower view; views that share no point are never a pair.
// \param partners_per_view  the paper's 2
std::vector<ViewPair> SelectViewPairs(const PointCloud& points,
                                      size_t num_views, int partners_per_view);

}  // namespace colmap_ext
