#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/percentile.h"
#include "cameras/refine_cameras.h"

namespace colmap_ext {
namespace {

constexpr int kNumSteps = std::tuple_size_v<RadialShifts> - 1;
using StepVector = Eigen::Vector<double, kNumSteps + 1>;  // px of the level
using StepMatrix = Eigen::Matrix<double, kNumSteps + 1, kNumSteps + 1>;

// What one of the two cameras adds to a shift across the epipolar line.
struct CameraPart {
  uint32_t camera = 0;
  StepVector by_steps = StepVector::Zero();
};

// \param across  the derivative of the shift by the pixel's position
CameraPart PartOf(const View& view, uint32_t camera,
                  const Eigen::Vector2d& pixel, const Eigen::Vector2d& across) {
  const Eigen::Vector2d offset = pixel - Eigen::Vector2d(view.cx, view.cy);
  const double distance = std::max(offset.norm(), 1e-9);
  const double place = std::min(distance / HalfDiagonal(view), 1.0) * kNumSteps;
  const int step = std::min(static_cast<int>(place), kNumSteps - 1);
  CameraPart part{camera};
  part.by_steps[step] = 1 - (place - step);
  part.by_steps[step + 1] = place - step;
  part.by_steps *= across.dot(offset) / distance;
  return part;
}

struct CrossShift {
  double value = 0;  // px
  std::array<CameraPart, 2> parts;
};

CrossShift Across(const std::vector<View>& views,
                  const std::vector<uint32_t>& view_cameras,
                  const SurfacePatch& patch, const ShiftMeasurement& shift) {
  const Eigen::Vector2d across =
      shift.jacobian.by_displacement.unitOrthogonal();
  return {across.dot(shift.shift),
          {PartOf(views[shift.j], view_cameras[shift.j], shift.jacobian.pixel_j,
                  across),
           PartOf(views[shift.i], view_cameras[shift.i],
                  {patch.col + 0.5, patch.row + 0.5},
                  -shift.jacobian.by_pixel_i.transpose() * across)}};
}

// Pulls the values towards 0 and towards each other, and fixes the first at 0.
// \param noise  of the shifts, px
StepMatrix Regularization(double noise) {
  constexpr double kSize = 0.3;   // standard deviation, px: a choice
  constexpr double kSmooth = 20;  // weight of the differences: a choice
  StepMatrix matrix = StepMatrix::Identity();
  matrix(0, 0) = 1e9;
  for (int k = 0; k < kNumSteps; ++k) {
    StepVector slope = StepVector::Zero();
    slope.segment<2>(k) << -1, 1;
    matrix += kSmooth * slope * slope.transpose();
  }
  return noise * noise / (kSize * kSize) * matrix;
}

// The normal equations of a camera, and how well it explains its shifts.
struct CameraSums {
  StepMatrix matrix = StepMatrix::Zero();
  StepVector right = StepVector::Zero();
  double count = 0;
  double before = 0;  // weighted squares of the shifts
  double after = 0;   // ... and of what is left

  // Whether it explains clearly more than chance would. Choices.
  bool Explains() const {
    return before - after > (0.02 + 20 * kNumSteps / count) * before;
  }
};

}  // namespace

std::vector<RadialShifts> EstimateRadialShifts(
    const std::vector<View>& views, const std::vector<uint32_t>& view_cameras,
    const std::vector<SurfacePatch>& patches,
    const std::vector<ShiftMeasurement>& shifts) {
  constexpr int kPasses = 12;
  constexpr double kRelaxation = 0.7;  // cameras are solved side by side
  constexpr double kRobust = 1.5;      // medians
  std::vector<CrossShift> all;
  for (const ShiftMeasurement& shift : shifts) {
    all.push_back(Across(views, view_cameras, patches[shift.patch], shift));
  }
  const size_t num_cameras = size_t{1} + std::ranges::max(view_cameras);
  std::vector<StepVector> steps(num_cameras, StepVector::Zero());
  std::vector<CameraSums> sums;
  for (int pass = 0; pass < kPasses && !all.empty(); ++pass) {
    std::vector<double> left;
    std::vector<double> sizes;
    for (const auto& [value, parts] : all) {
      left.push_back(value - parts[0].by_steps.dot(steps[parts[0].camera]) -
                     parts[1].by_steps.dot(steps[parts[1].camera]));
      sizes.push_back(std::abs(left.back()));
    }
    const double scale = std::max(kRobust * Median(&sizes), 1e-6);
    sums.assign(num_cameras, {});
    for (size_t k = 0; k < all.size(); ++k) {
      const double weight = 1 / (1 + left[k] * left[k] / (scale * scale));
      const auto add = [&](uint32_t camera, const StepVector& row) {
        CameraSums& sum = sums[camera];
        sum.matrix += weight * row * row.transpose();
        sum.right += weight * (left[k] + row.dot(steps[camera])) * row;
        ++sum.count;
        sum.before += weight * all[k].value * all[k].value;
        sum.after += weight * left[k] * left[k];
      };
      const auto& [first, second] = all[k].parts;
      if (first.camera == second.camera) {
        add(first.camera, first.by_steps + second.by_steps);
      } else {
        add(first.camera, first.by_steps);
        add(second.camera, second.by_steps);
      }
    }
    for (size_t camera = 0; camera < num_cameras; ++camera) {
      const CameraSums& sum = sums[camera];
      steps[camera] +=
          kRelaxation *
          ((sum.matrix + Regularization(scale)).llt().solve(sum.right) -
           steps[camera]);
    }
  }
  if (std::ranges::none_of(sums, &CameraSums::Explains)) {
    return {};
  }
  std::vector<RadialShifts> radial(views.size());
  for (size_t view = 0; view < views.size(); ++view) {
    const uint32_t camera = view_cameras[view];
    if (sums[camera].Explains()) {
      for (int k = 1; k <= kNumSteps; ++k) {
        radial[view][k] = steps[camera][k] / HalfDiagonal(views[view]);
      }
    }
  }
  return radial;
}

}  // namespace colmap_ext
