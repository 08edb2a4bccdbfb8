#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include "base/indices.h"
#include "cameras/camera_residuals.h"
#include "cameras/landmarks.h"
#include "cameras/refine_cameras.h"

namespace colmap_ext {
namespace {

// The priors of the cameras' steps: normal distributions of each number.
struct CameraPriorTerms {
  Eigen::VectorXd means;
  Eigen::VectorXd informations;  // inverse variances; infinite: stays

  CameraPriorTerms(const CameraEvidence& evidence, const CameraSet& original,
                   const CameraSet& start, const CameraSteps& steps)
      : means(Eigen::VectorXd::Zero(steps.values.size())),
        informations(Eigen::VectorXd::Constant(steps.values.size(), HUGE_VAL)) {
    const CameraPriors& priors = evidence.priors;
    for (size_t i = 0; i < start.views.size(); ++i) {
      const View& before = original.views[i];
      const View& now = start.views[i];
      ViewStep moved;
      moved << StepBetween(before, now), std::log(now.fx / before.fx),
          (now.cx - before.cx) / before.fx, (now.cy - before.cy) / before.fy;
      const double angle = priors.pose / now.fx;
      ViewStep sigmas;
      sigmas << Eigen::Vector3d::Constant(angle),
          Eigen::Vector3d::Constant(angle * evidence.depths[i]),
          priors.focal_length, priors.principal_point, priors.principal_point;
      const auto indices = steps.Indices(i);
      for (int k = 0; k < kViewDim; ++k) {
        if (k < 6 ? evidence.is_skipped[i] == 0 : evidence.refine_intrinsics) {
          means[indices[k]] = -moved[k];
          informations[indices[k]] = 1 / (sigmas[k] * sigmas[k]);
        }
      }
    }
  }

  bool IsFixed(Eigen::Index index) const {
    return informations[index] == HUGE_VAL;
  }

  double Cost(const CameraSteps& steps) const {
    double sum = 0;
    for (Eigen::Index k = 0; k < means.size(); ++k) {
      const double distance = steps.values[k] - means[k];
      sum += IsFixed(k) ? 0 : 0.5 * informations[k] * distance * distance;
    }
    return sum;
  }
};

// Maps the steps of the leaders to the steps of all views, to first order. The
// columns of the other poses are 0.
Eigen::SparseMatrix<double> StepsByLeaders(const CameraSet& cameras,
                                           Eigen::Index size) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto num_views = static_cast<Eigen::Index>(cameras.views.size());
  for (Eigen::Index i = 0; i < num_views; ++i) {
    const uint32_t leader = cameras.LeaderOf(i);
    const RelativePose pose(cameras.views[i], cameras.views[leader]);
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    block.topLeftCorner<3, 3>() = pose.rotation;
    block.bottomRightCorner<3, 3>() = pose.rotation;
    block.bottomLeftCorner<3, 3>() =
        -pose.rotation.colwise().cross(pose.translation);
    for (Eigen::Index k = 0; k < block.size(); ++k) {
      entries.emplace_back(6 * i + k % 6, 6 * leader + k / 6,
                           block(k % 6, k / 6));
    }
  }
  for (Eigen::Index k = 6 * num_views; k < size; ++k) {
    entries.emplace_back(k, k, 1);  // intrinsics
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Levenberg and Marquardt's method.
class Problem {
 public:
  Problem(const CameraEvidence& evidence, const CameraSet& original,
          const CameraEstimate& start)
      : original_(original),
        num_views_(start.cameras.views.size()),
        steps_{original.view_cameras},
        priors_(evidence, original, start.cameras, steps_),
        patches_({evidence, start.displacements}, steps_, num_views_),
        points_({evidence, start.cameras.views, start.positions}, steps_,
                num_views_) {
    if (!original.leaders.empty()) {
      by_leaders_ = StepsByLeaders(original, steps_.values.size());
    }
    system_.columns = MakeRows<uint32_t>(
        num_views_, [&](size_t view, std::vector<uint32_t>* columns) {
          std::vector<uint32_t> neighbors{static_cast<uint32_t>(view)};
          patches_.AppendNeighbors(static_cast<uint32_t>(view), &neighbors);
          points_.AppendNeighbors(static_cast<uint32_t>(view), &neighbors);
          SortUnique(&neighbors);
          Append(neighbors, columns);
        });
  }

  // \return whether the cost is a number
  bool Solve() {
    constexpr int kMaxIterations = 12;
    // Of the cost: the windows are compared anew after each solution; a choice.
    constexpr double kMinGain = 1e-3;
    constexpr double kDampingFactor = 10;
    double cost = Cost(steps_, false);
    if (!std::isfinite(cost)) {
      return false;
    }
    double damping = 1e-4;
    bool is_linearized = false;
    for (int i = 0; i < kMaxIterations; ++i) {
      if (!std::exchange(is_linearized, true)) {
        patches_.Linearize(steps_);
        points_.Linearize(steps_);
      }
      const std::optional<CameraSteps> steps = FindSteps(damping);
      const double gain = steps ? cost - Cost(*steps, true) : -HUGE_VAL;
      if (!(gain > 0)) {
        damping *= kDampingFactor;
        continue;
      }
      steps_.values = steps->values;
      patches_.Move();
      points_.Move();
      is_linearized = false;
      cost -= gain;
      if (gain < kMinGain * cost) {
        break;
      }
      damping /= kDampingFactor;
    }
    return true;
  }

  void Store(CameraEstimate* estimate) const {
    for (size_t i = 0; i < num_views_; ++i) {
      View& view = estimate->cameras.views[i];
      const ViewStep step = steps_[i];
      view = MoveView(view, step.head<6>(), step.tail<3>());
    }
    FollowLeaders(original_, &estimate->cameras.views);
    for (size_t i = 0; i < patches_.At().size(); ++i) {
      estimate->displacements[i] = patches_.At()[i][0];
    }
    estimate->positions = points_.At();
  }

 private:
  double Cost(const CameraSteps& steps, bool moves) const {
    return priors_.Cost(steps) + patches_.Cost(steps, moves) +
           points_.Cost(steps, moves);
  }

  // The cameras' steps; the landmarks get theirs.
  // \return nothing if the equations cannot be solved
  std::optional<CameraSteps> FindSteps(double damping) {
    system_.blocks.assign(system_.columns.values.size(), ViewBlock::Zero());
    system_.slopes.assign(num_views_, ViewStep::Zero());
    patches_.AddTo(steps_, damping, &system_);
    points_.AddTo(steps_, damping, &system_);
    Eigen::VectorXd slopes = Eigen::VectorXd::Zero(steps_.values.size());
    for (size_t i = 0; i < num_views_; ++i) {
      slopes(steps_.Indices(i)) += system_.slopes[i];
    }
    Eigen::SparseMatrix<double> matrix = Matrix();
    for (Eigen::Index k = 0; k < slopes.size(); ++k) {
      double& diagonal = matrix.coeffRef(k, k);
      if (priors_.IsFixed(k)) {
        slopes[k] = 0;
        diagonal = 1;
      } else {
        slopes[k] +=
            priors_.informations[k] * (steps_.values[k] - priors_.means[k]);
        diagonal += priors_.informations[k];
      }
      diagonal *= 1 + damping;
    }
    const Eigen::VectorXd solution = original_.leaders.empty()
                                         ? -SolutionOf(matrix, slopes)
                                         : -SolutionOfRigs(matrix, slopes);
    if (!solution.allFinite()) {
      return std::nullopt;
    }
    CameraSteps change = steps_;
    change.values = solution;
    patches_.FindSteps(change);
    points_.FindSteps(change);
    change.values += steps_.values;
    return change;
  }

  // The lower triangle of the cameras' matrix, without its priors and what
  // stays.
  Eigen::SparseMatrix<double> Matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(system_.blocks.size() * kViewDim * kViewDim);
    const auto add = [&](const auto& rows, const auto& cols,
                         const ViewBlock& block) {
      for (int r = 0; r < kViewDim; ++r) {
        for (int c = 0; c < kViewDim; ++c) {
          if (rows[r] >= cols[c] && !priors_.IsFixed(rows[r]) &&
              !priors_.IsFixed(cols[c])) {
            entries.emplace_back(rows[r], cols[c], block(r, c));
          }
        }
      }
    };
    for (size_t i = 0; i < num_views_; ++i) {
      const auto rows = steps_.Indices(i);
      for (uint64_t k = system_.columns.offsets[i];
           k < system_.columns.offsets[i + 1]; ++k) {
        const size_t j = system_.columns.values[k];
        add(rows, steps_.Indices(j), system_.blocks[k]);
        if (i != j) {
          add(steps_.Indices(j), rows, system_.blocks[k].transpose());
        }
      }
    }
    const Eigen::Index size = steps_.values.size();
    for (Eigen::Index k = 0; k < size; ++k) {
      entries.emplace_back(k, k, 0);
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  // The same by the reduced equations of the leaders, see StepsByLeaders().
  Eigen::VectorXd SolutionOfRigs(const Eigen::SparseMatrix<double>& lower,
                                 const Eigen::VectorXd& right) const {
    const Eigen::SparseMatrix<double> all =
        lower.selfadjointView<Eigen::Lower>();
    Eigen::SparseMatrix<double> matrix =
        by_leaders_.transpose() * (all * by_leaders_);
    for (size_t i = 0; i < num_views_; ++i) {
      for (size_t k = 6 * i; original_.LeaderOf(i) != i && k < 6 * i + 6; ++k) {
        matrix.coeffRef(static_cast<Eigen::Index>(k),
                        static_cast<Eigen::Index>(k)) = 1;
      }
    }
    return by_leaders_ * SolutionOf(matrix, by_leaders_.transpose() * right);
  }

  // NaN where the equations cannot be solved.
  Eigen::VectorXd SolutionOf(const Eigen::SparseMatrix<double>& matrix,
                             const Eigen::VectorXd& right) const {
    // From so many views on the reduced system is sparse as a rule.
    constexpr size_t kMaxDense = 300;
    const auto solve = [&](const auto& factors) -> Eigen::VectorXd {
      return factors.info() == Eigen::Success
                 ? factors.solve(right).eval()
                 : Eigen::VectorXd::Constant(right.size(), std::nan(""));
    };
    return num_views_ <= kMaxDense
               ? solve(Eigen::LLT<Eigen::MatrixXd>(matrix))
               : solve(
                     Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>(matrix));
  }

  const CameraSet& original_;
  size_t num_views_;
  Eigen::SparseMatrix<double> by_leaders_;  // with rigs, see StepsByLeaders()
  CameraSteps steps_;
  CameraPriorTerms priors_;
  Landmarks<PatchShifts> patches_;
  Landmarks<TrackProjections> points_;
  ReducedSystem system_;
};

}  // namespace

bool SolveCameras(const CameraEvidence& evidence, const CameraSet& original,
                  CameraEstimate* estimate) {
  Problem problem(evidence, original, *estimate);
  if (!problem.Solve()) {
    return false;
  }
  problem.Store(estimate);
  return true;
}

}  // namespace colmap_ext
