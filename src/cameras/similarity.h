#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// x -> scale rotation x + translation, world to world.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  bool IsIdentity() const {
    return scale == 1 && rotation.isIdentity(0) && translation.isZero(0);
  }

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const {
    return scale * (rotation * point) + translation;
  }
};

// The similarity that takes points to where others are, by least squares
// [Umeyama1991], robustly: points that stay far from their counterparts count
// little. The identity if fewer than ten points have a weight.
// \param from, to  [P] scene units
// \param footprints  [P] what a distance is measured in, scene units; 0 leaves
//        a point out.
Similarity AlignPoints(const std::vector<Eigen::Vector3d>& from,
                       const std::vector<Eigen::Vector3d>& to,
                       const std::vector<double>& footprints);

// The view that sees the moved world as the view saw the world before; lengths
// in its frame are scaled too.
View TransformView(const Similarity& similarity, const View& view);

}  // namespace colmap_ext
