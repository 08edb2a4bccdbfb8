#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/growing_complex.h"
#include "delaunay/tetrahedralization.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

// Inserts points one after the other into an empty complex, without the
// redundant ones.
// \param points  [complex points] of the cloud, along the curve
// \param order   of insertion, indices into points
// \param representatives [P] of redundant points are set to the point of the
//        nearest vertex of the cell that they fall into
// \throw std::invalid_argument where the points span no volume or are too many
//        for 32-bit cell indices
void InsertThinned(const PointCloud& cloud, const std::vector<View>& views,
                   const ThinningOptions& options,
                   const std::vector<uint32_t>& points,
                   const std::vector<uint32_t>& order,
                   std::vector<uint32_t>* representatives,
                   const Progress& progress, GrowingComplex* complex);

}  // namespace colmap_ext
