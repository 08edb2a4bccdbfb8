#include "cameras/refine_cameras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

namespace colmap_ext {
namespace {

using RowMajor2x6 = Eigen::Matrix<double, 2, 6, Eigen::RowMajor>;
using RowMajor2x3 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

// W (J x - shift): blocks pose i, pose j, displacement, and the intrinsics of
// one camera or of two.
class ShiftCost : public ceres::CostFunction {
 public:
  ShiftCost(const ShiftMeasurement& measured, double displacement,
            int num_intrinsics)
      : by_pose_i_(measured.whitening * measured.jacobian.by_pose_i),
        by_pose_j_(measured.whitening * measured.jacobian.by_pose_j),
        by_displacement_(measured.whitening *
                         measured.jacobian.by_displacement),
        constant_(-measured.whitening * measured.shift -
                  by_displacement_ * displacement) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {6, 6, 1};
    by_intrinsics_[0] = measured.whitening * measured.jacobian.by_intrinsics_i;
    by_intrinsics_[1] = measured.whitening * measured.jacobian.by_intrinsics_j;
    if (num_intrinsics == 1) {
      by_intrinsics_[0] += by_intrinsics_[1];
    }
    for (int k = 0; k < num_intrinsics; ++k) {
      mutable_parameter_block_sizes()->push_back(3);
    }
  }

  bool Evaluate(double const* const* blocks, double* residuals,
                double** jacobians) const override {
    const size_t num_intrinsics = parameter_block_sizes().size() - 3;
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    residual = constant_ + by_pose_i_ * Eigen::Map<const PoseStep>(blocks[0]) +
               by_pose_j_ * Eigen::Map<const PoseStep>(blocks[1]) +
               by_displacement_ * blocks[2][0];
    for (size_t k = 0; k < num_intrinsics; ++k) {
      residual +=
          by_intrinsics_[k] * Eigen::Map<const IntrinsicsStep>(blocks[3 + k]);
    }
    const auto copy = [&]<typename Matrix>(const Matrix& by_block, size_t k) {
      if (jacobians != nullptr && jacobians[k] != nullptr) {
        Eigen::Map<Matrix>{jacobians[k]} = by_block;
      }
    };
    copy(by_pose_i_, 0);
    copy(by_pose_j_, 1);
    copy(by_displacement_, 2);
    for (size_t k = 0; k < num_intrinsics; ++k) {
      copy(by_intrinsics_[k], 3 + k);
    }
    return true;
  }

 private:
  RowMajor2x6 by_pose_i_;
  RowMajor2x6 by_pose_j_;
  Eigen::Vector2d by_displacement_;
  std::array<RowMajor2x3, 2> by_intrinsics_;
  Eigen::Vector2d constant_;
};

// (projection - observation) / sigma: blocks pose step, intrinsics step, point.
class ReprojectionCost {
 public:
  ReprojectionCost(const View& view, Eigen::Vector2d pixel, double sigma)
      : view_(view), pixel_(std::move(pixel)), sigma_(sigma) {}

  template <typename T>
  bool operator()(const T* pose, const T* intrinsics, const T* point,
                  T* residual) const {
    const Eigen::Matrix<T, 3, 1> in_view =
        view_.cam_from_world_rotation.template cast<T>() *
            Eigen::Map<const Eigen::Matrix<T, 3, 1>>(point) +
        view_.cam_from_world_translation.template cast<T>();
    T moved[3];
    ceres::AngleAxisRotatePoint(pose, in_view.data(), moved);
    for (int k = 0; k < 3; ++k) {
      moved[k] += pose[3 + k];
    }
    if (!(moved[2] > T(0))) {
      return false;
    }
    const T scale = exp(intrinsics[0]) / moved[2];
    residual[0] = (view_.fx * (scale * moved[0] + intrinsics[1]) + view_.cx -
                   pixel_.x()) /
                  sigma_;
    residual[1] = (view_.fy * (scale * moved[1] + intrinsics[2]) + view_.cy -
                   pixel_.y()) /
                  sigma_;
    return true;
  }

 private:
  const View& view_;
  Eigen::Vector2d pixel_;
  double sigma_;
};

// A problem and its variables. The views, which costs refer to, have to stay.
class Problem {
 public:
  Problem(const CameraEvidence& evidence, const CameraSet& original,
          CameraEstimate* estimate)
      : evidence_(evidence),
        original_(original),
        estimate_(estimate),
        num_views_(original.views.size()),
        num_cameras_(size_t{1} + std::ranges::max(original.view_cameras)),
        first_point_(estimate->displacements.size()),
        first_pose_(first_point_ + 3 * estimate->positions.size()),
        first_intrinsics_(first_pose_ + 6 * num_views_),
        variables_(first_intrinsics_ + 3 * num_cameras_, 0) {
    std::ranges::copy(estimate->displacements, variables_.begin());
    for (size_t i = 0; i < estimate->positions.size(); ++i) {
      Eigen::Map<Eigen::Vector3d>{Point(i)} = estimate->positions[i];
    }
  }

  bool Solve() {
    AddShifts();
    AddTracks();
    AddCameras();
    ceres::Solver::Options options;
    // From so many views on the reduced system is sparse as a rule.
    constexpr size_t kMaxDense = 300;
    // Eigen's solvers run on one thread. SuiteSparse's sums have an order that
    // depends on the threads of the BLAS.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    const bool is_dense =
        num_views_ <= kMaxDense ||
        !ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE);
    options.linear_solver_type =
        is_dense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = ordering_;
    options.num_threads = 1;
    options.max_num_iterations = 12;
    // The windows are compared anew after each solution; a choice.
    options.function_tolerance = 1e-3;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable()) {
      return false;
    }
    for (size_t i = 0; i < num_views_; ++i) {
      View& view = estimate_->cameras.views[i];
      view = MoveView(view, Eigen::Map<const PoseStep>(Pose(i)),
                      Eigen::Map<const IntrinsicsStep>(Intrinsics(i)));
    }
    std::copy_n(variables_.begin(), first_point_,
                estimate_->displacements.begin());
    for (size_t i = 0; i < estimate_->positions.size(); ++i) {
      estimate_->positions[i] = Eigen::Map<const Eigen::Vector3d>(Point(i));
    }
    return true;
  }

 private:
  double* Displacement(size_t patch) { return &variables_[patch]; }
  double* Point(size_t point) { return &variables_[first_point_ + 3 * point]; }
  double* Pose(size_t view) { return &variables_[first_pose_ + 6 * view]; }
  double* Intrinsics(size_t view) {
    return &variables_[first_intrinsics_ + 3 * original_.view_cameras[view]];
  }

  // (offset + block) / sigma, each row by its own.
  void AddPrior(const Eigen::VectorXd& offset, const Eigen::VectorXd& sigmas,
                double* block) {
    problem_.AddResidualBlock(
        new ceres::NormalPrior(sigmas.cwiseInverse().asDiagonal(), -offset),
        nullptr, block);
  }

  void AddShifts() {
    std::vector<uint8_t> is_added(estimate_->displacements.size(), 0);
    const Eigen::VectorXd sigma =
        Eigen::VectorXd::Constant(1, evidence_.priors.displacement);
    for (const ShiftMeasurement& shift : evidence_.shifts) {
      double* displacement = Displacement(shift.patch);
      std::vector<double*> blocks = {Pose(shift.i), Pose(shift.j),
                                     displacement};
      if (evidence_.refine_intrinsics) {
        blocks.push_back(Intrinsics(shift.i));
        if (Intrinsics(shift.j) != Intrinsics(shift.i)) {
          blocks.push_back(Intrinsics(shift.j));
        }
      }
      problem_.AddResidualBlock(
          new ShiftCost(shift, *displacement,
                        static_cast<int>(blocks.size()) - 3),
          robust_.get(), blocks);
      if (std::exchange(is_added[shift.patch], 1) == 0) {
        ordering_->AddElementToGroup(displacement, 0);
        AddPrior(Eigen::VectorXd::Zero(1), sigma, displacement);
      }
    }
  }

  void AddTracks() {
    const SparseTracks& tracks = evidence_.tracks;
    for (size_t i = 0; i < tracks.positions.size(); ++i) {
      double footprint = 0;
      for (const TrackObservation& seen : tracks.observations[i]) {
        const View& view = estimate_->cameras.views[seen.view];
        const double depth = view.CamFromWorld(estimate_->positions[i]).z();
        if (!(depth > 0)) {
          continue;
        }
        footprint = std::max(footprint, depth / view.fx);
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<ReprojectionCost, 2, 6, 3, 3>(
                new ReprojectionCost(view, seen.pixel,
                                     evidence_.track_sigmas[seen.view])),
            robust_.get(), Pose(seen.view), Intrinsics(seen.view), Point(i));
      }
      if (footprint > 0) {
        ordering_->AddElementToGroup(Point(i), 0);
        AddPrior(-tracks.positions[i],
                 Eigen::Vector3d::Constant(evidence_.priors.point * footprint),
                 Point(i));
      }
    }
  }

  void AddCameras() {
    const CameraPriors& priors = evidence_.priors;
    for (size_t i = 0; i < num_views_; ++i) {
      const View& view = estimate_->cameras.views[i];
      PoseStep sigmas;
      sigmas << Eigen::Vector3d::Constant(priors.pose / view.fx),
          Eigen::Vector3d::Constant(priors.pose * evidence_.depths[i] /
                                    view.fx);
      double* pose = Pose(i);
      AddPrior(StepBetween(original_.views[i], view), sigmas, pose);
      ordering_->AddElementToGroup(pose, 1);
      if (evidence_.is_skipped[i] != 0) {
        problem_.SetParameterBlockConstant(pose);
      }
    }
    AddIntrinsics();
  }

  void AddIntrinsics() {
    const CameraPriors& priors = evidence_.priors;
    std::vector<uint8_t> is_added(num_cameras_, 0);
    for (size_t i = 0; i < num_views_; ++i) {
      if (std::exchange(is_added[original_.view_cameras[i]], 1) != 0) {
        continue;
      }
      const View& before = original_.views[i];
      const View& now = estimate_->cameras.views[i];
      double* block = Intrinsics(i);
      AddPrior(Eigen::Vector3d(std::log(now.fx / before.fx),
                               (now.cx - before.cx) / before.fx,
                               (now.cy - before.cy) / before.fy),
               Eigen::Vector3d(priors.focal_length, priors.principal_point,
                               priors.principal_point),
               block);
      ordering_->AddElementToGroup(block, 1);
      if (!evidence_.refine_intrinsics) {
        problem_.SetParameterBlockConstant(block);
      }
    }
  }

  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  const CameraEvidence& evidence_;
  const CameraSet& original_;
  CameraEstimate* estimate_;
  size_t num_views_;
  size_t num_cameras_;
  size_t first_point_;  // in variables_
  size_t first_pose_;
  size_t first_intrinsics_;
  // Displacements, points, pose steps, intrinsics steps. In one array, as Ceres
  // orders variables by their addresses, and sums by that order.
  std::vector<double> variables_;
  std::unique_ptr<ceres::LossFunction> robust_ =
      std::make_unique<ceres::CauchyLoss>(kRobustScale);
  // Group 0 is eliminated.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
      std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::Problem problem_{ProblemOptions()};
};

}  // namespace

bool SolveCameras(const CameraEvidence& evidence, const CameraSet& original,
                  CameraEstimate* estimate) {
  return Problem(evidence, original, estimate).Solve();
}

}  // namespace colmap_ext
