#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "photometry/image_pyramid.h"
#include "refine/facetwise_refinement.h"
#include "scene/view.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

// The model, read in full, as the refinement of the cameras takes it.
// \param order  [views] the image of the model that each view is.
// \param views  by the pictures' sizes, which may not be the cameras'.
std::shared_ptr<const RefinableCameras> MakeRefinableCameras(
    const SparseModel& model, const std::vector<size_t>& order,
    const std::vector<View>& views, std::shared_ptr<ImagePyramid> images);

// The model with other poses and points, and, if `has_intrinsics`, other
// intrinsics, scaled to the cameras' sizes.
// \param order  as above
// \param positions  [P]
SparseModel WithRefinedCameras(SparseModel model,
                               const std::vector<size_t>& order,
                               const std::vector<View>& views,
                               bool has_intrinsics,
                               const std::vector<Eigen::Vector3d>& positions);

}  // namespace colmap_ext
