#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "cameras/camera_set.h"
#include "cameras/surface_patches.h"
#include "labeling/view_pairs.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"
#include "raster/visibility_buffers.h"

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
// (Schur complement) [Triggs1999], by Levenberg and Marquardt's method.
// \param original  the priors' cameras
// \param estimate  the start, and the result
// \return whether there is a result: not where the cost is no finite number
bool SolveCameras(const CameraEvidence& evidence, const CameraSet& original,
                  CameraEstimate* estimate);

enum class RefinedParts {
  kNothing,
  kPoses,
  kPosesIntrinsics,  // focal length and principal point too
};

struct CameraRefinementOptions {
  RefinedParts parts = RefinedParts::kNothing;
  // Do not refine cameras that are aligned well, see RefineFacetwise().
  bool only_if_misaligned = false;
  PatchOptions patches;
  CameraPriors priors;

  // Observations of the sparse model's points that are used, if it has as many;
  // the longest tracks first.
  size_t min_observations_per_view = 300;

  // Comparisons and solutions at a level, at most.
  int max_rounds = 4;
  // Windows that match worse are left out; in [-1, 1].
  double min_zncc = 0.5;
};

// The report of one view.
struct RefinedView {
  size_t num_windows = 0;       // that match
  size_t num_observations = 0;  // of the sparse model's points
  double motion = 0;            // median, px, since the original
  double last_motion = 0;       // in the last round, px of the level
  bool is_skipped = false;      // too little evidence to move it
};

struct CameraRefinementReport {
  int level = 0;
  int num_rounds = 0;
  size_t num_windows = 0;  // that match in the last round
  double mean_zncc = 0;    // of them
  double mean_zncc_before = 0;
  double track_sigma = 0;   // of the observations, px
  double total_motion = 0;  // of the view that moved most, RMS, px of the level
  std::vector<RefinedView> views;
};

struct RefinedCameras {
  CameraSet cameras;
  std::vector<Eigen::Vector3d> positions;  // [P] of the tracks
  CameraRefinementReport report;
};

// How far the images' misalignment would move the surface, and how far off it
// is: medians over its patches, footprints of a pixel of the level.
struct Misalignment {
  double by_cameras = 0;
  double of_surface = 0;
  std::vector<double> by_view;  // [views] by_cameras, of the patches chosen in
                                // each; 0 where there are too few to tell
  // [views] Of their lenses; empty if they explain nothing.
  std::vector<RadialShifts> radial_shifts;
  double motion = 0;  // of the view that moves most, see RefinedView
  // Whether it is a good part of the surface's error, a choice.
  bool IsLarge() const { return by_cameras > 0.5 * of_surface; }
};

// The distortion that COLMAP's camera model leaves: what explains shifts of
// windows across the epipolar lines, where no surface does.
// \param views  of the level
// \return [views] empty if no camera's explain a good part of its shifts
std::vector<RadialShifts> EstimateRadialShifts(
    const std::vector<View>& views, const std::vector<uint32_t>& view_cameras,
    const std::vector<SurfacePatch>& patches,
    const std::vector<ShiftMeasurement>& shifts);

// What the cameras are refined by. References are kept.
struct CameraInput {
  const PhotometricOptions& photometric;
  const SparseTracks& tracks;
  const VisibilityBuffers& buffers;    // of the surface, by the cameras as they
                                       // are now
  const std::vector<ViewPair>& pairs;  // views that may be compared
  ImagePyramid* images;                // at the level
};

// Moves the cameras so that the surface looks the same in all images, as far as
// no motion of the surface along its normals would do that (docs/method.md,
// section 7.7).
//
// \pre options.parts is not kNothing
// \param original  before all refinement: they hold the gauge.
// \param cameras  as they are now.
RefinedCameras RefineCameras(const CameraRefinementOptions& options,
                             const CameraInput& input,
                             const CameraSet& original, CameraSet cameras);

// \param min_share  of what all views together would move the surface by.
// \return the views that would move the surface by more than it is off, and by
//         more than that share, in ascending order.
std::vector<uint32_t> MisalignedViews(const Misalignment& misalignment,
                                      double min_share = 0);

// Compares where the surface's patches go with the cameras as they are, and
// with refined ones.
Misalignment MeasureMisalignment(const CameraRefinementOptions& options,
                                 const CameraInput& input,
                                 const CameraSet& cameras);

}  // namespace colmap_ext
