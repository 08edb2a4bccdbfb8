#pragma once

#include <cstddef>
#include <vector>

#include "labeling/facet_labels.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// For each view the pairs with the views that it shares the most points with
// (docs/method.md, section 4.1; L^simpl of [Romanoni2020, section V]): each
// pair once, ascending. Ties go to the lower view; views that share no point
// are never a pair.
// \param points  whose views are indices below num_views.
// \param partners_per_view  at most as many for each view; it can be in more
//        pairs. [Romanoni2020] has 2.
std::vector<ViewPair> SelectViewPairs(const PointCloud& points,
                                      size_t num_views, int partners_per_view);

}  // namespace colmap_ext
