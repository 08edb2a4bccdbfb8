#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"
#include "cameras/camera_set.h"
#include "cameras/refine_cameras.h"
#include "scene/view.h"

namespace colmap_ext {

// Of a view: PoseStep and IntrinsicsStep.
inline constexpr int kViewDim = 9;
using ViewStep = Eigen::Matrix<double, kViewDim, 1>;
using ViewBlock = Eigen::Matrix<double, kViewDim, kViewDim>;

// Steps of all poses, six numbers a view, and then of all cameras' intrinsics,
// three a camera.
struct CameraSteps {
  const std::vector<uint32_t>& view_cameras;  // see CameraSet
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(
      6 * view_cameras.size() +
      3 * (size_t{1} + std::ranges::max(view_cameras))));

  // Where the numbers of a view are in `values`.
  std::array<Eigen::Index, kViewDim> Indices(size_t view) const;

  ViewStep operator[](size_t view) const { return values(Indices(view)); }
};

// Two whitened differences and their derivatives: by the steps of one view or
// two, and by a landmark.
template <int kDim>
struct Residual {
  Eigen::Vector2d value;
  int num_views = 0;
  std::array<uint32_t, 2> views{};
  std::array<Eigen::Matrix<double, 2, kViewDim>, 2> by_views;
  Eigen::Matrix<double, 2, kDim> by_landmark;
};

// In place of a view: all.
inline constexpr uint32_t kAnyView = kNone;

// A normal distribution of a landmark, the same in all directions.
template <int kDim>
struct Prior {
  Eigen::Matrix<double, kDim, 1> mean;
  double sigma = 1;
};

// The shifts of patches, which move along their normals.
class PatchShifts {
 public:
  static constexpr int kDim = 1;
  using Landmark = Eigen::Matrix<double, 1, 1>;

  // \param displacements  at the start; are kept.
  PatchShifts(const CameraEvidence& evidence,
              const std::vector<double>& displacements);

  std::vector<Landmark> Start() const { return {start_.begin(), start_.end()}; }

  Prior<1> PriorOf(size_t /*patch*/) const {
    return {Landmark(0.0), evidence_.priors.displacement};
  }

  // Calls function(residual) for those of a patch that the steps of a view are
  // part of.
  template <typename Function>
  void ForEach(size_t patch, const CameraSteps& steps, const Landmark& at,
               uint32_t view, const Function& function) const {
    for (uint64_t k = offsets_[patch]; k < offsets_[patch + 1]; ++k) {
      const ShiftMeasurement& shift = evidence_.shifts[k];
      if (view == kAnyView || shift.i == view || shift.j == view) {
        function(ResidualOf(shift, steps, at[0]));
      }
    }
  }

 private:
  Residual<1> ResidualOf(const ShiftMeasurement& shift,
                         const CameraSteps& steps, double displacement) const;

  const CameraEvidence& evidence_;
  const std::vector<double>& start_;  // [patches] displacements
  std::vector<uint64_t> offsets_;     // [patches + 1] into the shifts
};

// The observations of the sparse model's points.
class TrackProjections {
 public:
  static constexpr int kDim = 3;
  using Landmark = Eigen::Vector3d;

  // \param views, positions  at the start; are kept.
  TrackProjections(const CameraEvidence& evidence,
                   const std::vector<View>& views,
                   const std::vector<Eigen::Vector3d>& positions)
      : evidence_(evidence), views_(views), start_(positions) {}

  const std::vector<Landmark>& Start() const { return start_; }

  // A point that no camera has before it stays.
  Prior<3> PriorOf(size_t point) const;

  // Calls function(residual) for those of a point that the steps of a view are
  // part of, without those of cameras that it is behind.
  template <typename Function>
  void ForEach(size_t point, const CameraSteps& steps, const Landmark& at,
               uint32_t view, const Function& function) const {
    for (const TrackObservation& seen : evidence_.tracks.observations[point]) {
      if ((view == kAnyView || seen.view == view) &&
          Depth(seen.view, point) > 0) {
        function(Project(seen, steps[seen.view], at));
      }
    }
  }

 private:
  double Depth(size_t view, size_t point) const {
    return views_[view].CamFromWorld(start_[point]).z();
  }

  // Infinite where the point comes to lie behind the camera.
  Residual<3> Project(const TrackObservation& seen, const ViewStep& step,
                      const Landmark& at) const;

  const CameraEvidence& evidence_;
  const std::vector<View>& views_;
  const std::vector<Eigen::Vector3d>& start_;
};

}  // namespace colmap_ext
