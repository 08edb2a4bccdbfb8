#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "scene/view.h"

namespace colmap_ext {

// What is refined: the cameras of a scene. Views of one camera share its
// intrinsics.
struct CameraSet {
  std::vector<View> views;             // of the pictures' full size
  std::vector<uint32_t> view_cameras;  // [views] index of the camera of each
  // [views] The view that each keeps its pose relative to: the first of a frame
  // of a rig leads the others and itself. Empty: there are no rigs.
  std::vector<uint32_t> leaders = {};

  uint32_t LeaderOf(size_t view) const {
    return leaders.empty() ? static_cast<uint32_t>(view) : leaders[view];
  }
};

// A feature of the sparse model in one of the images that show it.
struct TrackObservation {
  uint32_t view = 0;
  Eigen::Vector2d pixel;  // px of the full-size picture, see View
};

// The sparse model's points and where the images show them.
struct SparseTracks {
  std::vector<Eigen::Vector3d> positions;  // [P] world, scene units
  Rows<TrackObservation> observations;     // [P]
};

// A small change of a view. With the rotation exp(w) by the vector w, a point p
// of the camera's frame goes to exp(w) p + v: cam_from_world is multiplied from
// the left.
//   rows 0 to 2: w, rad; 3 to 5: v, scene units.
using PoseStep = Eigen::Matrix<double, 6, 1>;

// A small change of a camera. Row 0: of the logarithm of both focal lengths; 1,
// 2: of the principal point, in focal lengths.
using IntrinsicsStep = Eigen::Vector3d;

// The view after both changes.
View MoveView(const View& view, const PoseStep& pose,
              const IntrinsicsStep& intrinsics);

// A pose in the frame of another view: x -> rotation x + translation.
struct RelativePose {
  RelativePose(const View& view, const View& leader);

  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;  // scene units
};

// Gives the views of rigs the poses that follow from those of their leaders and
// the original poses relative to them.
void FollowLeaders(const CameraSet& original, std::vector<View>* views);

// The step that MoveView() goes from one pose to another.
PoseStep StepBetween(const View& from, const View& to);

// Where image j shows the point of a plane that a fixed pixel of image i shows,
// and how that changes (docs/method.md, section 7.7). All in px.
struct ShiftJacobian {
  Eigen::Vector2d pixel_j;
  Eigen::Matrix<double, 2, 6> by_pose_i;  // columns: PoseStep
  Eigen::Matrix<double, 2, 6> by_pose_j;
  Eigen::Matrix<double, 2, 3> by_intrinsics_i;  // columns: IntrinsicsStep
  Eigen::Matrix<double, 2, 3> by_intrinsics_j;
  Eigen::Vector2d by_displacement;  // of the plane along its normal, px / scene
                                    // unit; the direction of the epipolar line
  Eigen::Matrix2d by_pixel_i;       // the warp from i to j
};

// \param pixel_i  px in image i
// \param point  that it shows, world
// \param normal  of the plane, unit
// \pre the point lies before both cameras, and the plane is not seen edge-on
ShiftJacobian ComputeShiftJacobian(const View& view_i, const View& view_j,
                                   const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& normal);

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
// \param has_scale  else lengths stay
Similarity AlignPoints(const std::vector<Eigen::Vector3d>& from,
                       const std::vector<Eigen::Vector3d>& to,
                       const std::vector<double>& footprints, bool has_scale);

// The view that sees the moved world as the view saw the world before; lengths
// in its frame are scaled too.
View TransformView(const Similarity& similarity, const View& view);

// Standard deviations from which on a residual counts as an outlier: the scale
// of Cauchy's loss (docs/method.md, section 7.7). A choice.
inline constexpr double kRobustScale = 2;

// Cauchy's loss, and the weight that its derivative gives a squared residual.
inline double RobustLoss(double squared) {
  constexpr double kScale = kRobustScale * kRobustScale;
  return kScale * std::log1p(squared / kScale);
}
inline double RobustWeight(double squared) {
  return 1 / (1 + squared / (kRobustScale * kRobustScale));
}

// The longest tracks, until each view has so many observations or all of its
// own.
SparseTracks ChooseTracks(const SparseTracks& tracks, size_t num_views,
                          size_t min_observations_per_view);

// The points of the tracks where the views show them: each minimizes the robust
// sum of its squared reprojection errors, and of its squared distance from
// where it was.
// \param sigmas  [views] of an observation, px.
// \param point_sigma  of where a point was, px of the view where they are
//        largest.
// \return [P] world, scene units
std::vector<Eigen::Vector3d> LocateTracks(const SparseTracks& tracks,
                                          const std::vector<View>& views,
                                          const std::vector<double>& sigmas,
                                          double point_sigma);

}  // namespace colmap_ext
