#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "cameras/camera_set.h"

namespace colmap_ext {

// How far a window of view i has to shift in view j to match, and how the
// cameras and its patch shift it. In px of j's image.
struct ShiftMeasurement {
  uint32_t patch = 0;
  uint32_t i = 0;
  uint32_t j = 0;
  ShiftJacobian jacobian;  // displacement in footprints
  Eigen::Vector2d shift;   // from where it is now
  // W: W^T W is the inverse of the shift's covariance, 1 / px^2.
  Eigen::Matrix2d whitening;
};

// Priors: standard deviations of the changes.
struct CameraPriors {
  double pose = 10;               // px in the image, of each part of a step
  double focal_length = 0.01;     // of its logarithm
  double principal_point = 0.01;  // focal lengths
  double point = 5;               // px, of a point of the sparse model
  double displacement = 10;       // footprints, of a patch off the surface
};

// Input of the adjustment.
struct CameraEvidence {
  std::vector<ShiftMeasurement> shifts;  // by their patches
  const SparseTracks& tracks;
  std::vector<double> depths;        // [views] of what they see, scene units
  std::vector<double> track_sigmas;  // [views] of an observation, px
  std::vector<uint8_t> is_skipped;   // [views] too little evidence: not moved
  CameraPriors priors;
  bool refine_intrinsics = false;
};

// The unknowns of the adjustment.
struct CameraEstimate {
  CameraSet cameras;
  std::vector<double> displacements;       // [patches] footprints
  std::vector<Eigen::Vector3d> positions;  // [P] of the tracks
};

// Minimizes the robust sum of
//   the squared differences between the shifts that the cameras and the patches
//     make, to first order, and those measured,
//   the squared distances of the tracks' points from their observations,
//   and the priors,
// over poses, intrinsics, displacements and points, the last two eliminated
// (Schur complement) [Triggs1999], by Levenberg and Marquardt's method in
// Ceres, on one thread: sums have one order.
// \param original  the priors' cameras
// \param estimate  the start, and the result
// \return whether Ceres came to a usable solution
bool SolveCameras(const CameraEvidence& evidence, const CameraSet& original,
                  CameraEstimate* estimate);

}  // namespace colmap_ext
