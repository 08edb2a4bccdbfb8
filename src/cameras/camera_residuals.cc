#include "cameras/camera_residuals.h"

#include <limits>
#include <numeric>

#include <ceres/jet.h>
#include <ceres/rotation.h>

namespace colmap_ext {

std::array<Eigen::Index, kViewDim> CameraSteps::Indices(size_t view) const {
  std::array<Eigen::Index, kViewDim> indices{};
  const size_t intrinsics =
      6 * view_cameras.size() + size_t{3} * view_cameras[view];
  for (size_t k = 0; k < kViewDim; ++k) {
    indices[k] =
        static_cast<Eigen::Index>(k < 6 ? 6 * view + k : intrinsics + k - 6);
  }
  return indices;
}

PatchShifts::PatchShifts(const CameraEvidence& evidence,
                         const std::vector<double>& displacements)
    : evidence_(evidence),
      start_(displacements),
      offsets_(displacements.size() + 1, 0) {
  for (const ShiftMeasurement& shift : evidence.shifts) {
    ++offsets_[shift.patch + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
}

Residual<1> PatchShifts::ResidualOf(const ShiftMeasurement& shift,
                                    const CameraSteps& steps,
                                    double displacement) const {
  const ShiftJacobian& by = shift.jacobian;
  Residual<1> residual;
  residual.num_views = 2;
  residual.views = {shift.i, shift.j};
  residual.by_views[0] << by.by_pose_i, by.by_intrinsics_i;
  residual.by_views[1] << by.by_pose_j, by.by_intrinsics_j;
  residual.by_landmark = by.by_displacement;
  residual.value = by.by_displacement * (displacement - start_[shift.patch]) -
                   shift.shift + residual.by_views[0] * steps[shift.i] +
                   residual.by_views[1] * steps[shift.j];
  residual.value.applyOnTheLeft(shift.whitening);
  residual.by_landmark.applyOnTheLeft(shift.whitening);
  for (auto& by_view : residual.by_views) {
    by_view.applyOnTheLeft(shift.whitening);
  }
  return residual;
}

Prior<3> TrackProjections::PriorOf(size_t point) const {
  double footprint = 0;
  for (const TrackObservation& seen : evidence_.tracks.observations[point]) {
    footprint =
        std::max(footprint, Depth(seen.view, point) / views_[seen.view].fx);
  }
  return footprint > 0 ? Prior<3>{evidence_.tracks.positions[point],
                                  evidence_.priors.point * footprint}
                       : Prior<3>{start_[point], 1};
}

Residual<3> TrackProjections::Project(const TrackObservation& seen,
                                      const ViewStep& step,
                                      const Landmark& at) const {
  // By the view's step and the point.
  using Jet = ceres::Jet<double, kViewDim + kDim>;

  const View& view = views_[seen.view];
  std::array<Jet, kViewDim> camera;
  for (int k = 0; k < kViewDim; ++k) {
    camera[k] = Jet(step[k], k);
  }
  std::array<Jet, 3> in_view;
  for (int k = 0; k < 3; ++k) {
    in_view[k].a = view.cam_from_world_rotation.row(k).dot(at) +
                   view.cam_from_world_translation[k];
    in_view[k].v.setZero();
    in_view[k].v.tail<3>() = view.cam_from_world_rotation.row(k).transpose();
  }
  std::array<Jet, 3> moved;
  ceres::AngleAxisRotatePoint(camera.data(), in_view.data(), moved.data());
  for (int k = 0; k < 3; ++k) {
    moved[k] += camera[3 + k];
  }
  const Jet scale = exp(camera[6]) / moved[2];
  const double sigma = evidence_.track_sigmas[seen.view];
  const std::array<Jet, 2> values = {
      (view.fx * (scale * moved[0] + camera[7]) + view.cx - seen.pixel.x()) /
          sigma,
      (view.fy * (scale * moved[1] + camera[8]) + view.cy - seen.pixel.y()) /
          sigma};
  Residual<3> residual;
  residual.num_views = 1;
  residual.views = {seen.view, 0};
  for (int k = 0; k < 2; ++k) {
    residual.value[k] =
        moved[2].a > 0 ? values[k].a : std::numeric_limits<double>::infinity();
    residual.by_views[0].row(k) = values[k].v.head<kViewDim>().transpose();
    residual.by_landmark.row(k) = values[k].v.tail<3>().transpose();
  }
  return residual;
}

}  // namespace colmap_ext
