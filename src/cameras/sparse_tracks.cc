#include "cameras/sparse_tracks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include "cameras/camera_problem.h"
#include "cameras/camera_set.h"

namespace colmap_ext {

namespace {

// Cauchy's loss: the weight of a squared residual in Gauss-Newton's equations.
double RobustWeight(double squared) {
  return 1 / (1 + squared / (kRobustScale * kRobustScale));
}

// Normal equations of a point's motion.
struct PointEquations {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double footprint = 0;  // the largest, scene units

  void Add(const View& view, const TrackObservation& seen, double sigma,
           const Eigen::Vector3d& position) {
    const Eigen::Vector3d p = view.CamFromWorld(position);
    if (!(p.z() > 0)) {
      return;
    }
    const Eigen::Matrix<double, 2, 3> by_point =
        ProjectionJacobian(view, p) * (view.cam_from_world_rotation / sigma);
    const Eigen::Vector2d residual =
        (view.ImageFromCam(p) - seen.pixel) / sigma;
    const double weight = RobustWeight(residual.squaredNorm());
    matrix += weight * by_point.transpose() * by_point;
    gradient += weight * by_point.transpose() * residual;
    footprint = std::max(footprint, p.z() / view.fx);
  }
};

}  // namespace

double ReprojectionError(const View& view, const TrackObservation& seen,
                         const Eigen::Vector3d& position) {
  const Eigen::Vector3d in_view = view.CamFromWorld(position);
  return in_view.z() > 0 ? (view.ImageFromCam(in_view) - seen.pixel).norm()
                         : HUGE_VAL;
}

SparseTracks ChooseTracks(const SparseTracks& tracks, size_t num_views,
                          size_t min_observations_per_view) {
  std::vector<size_t> order(tracks.positions.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return tracks.observations[a].size() > tracks.observations[b].size();
  });
  std::vector<size_t> counts(num_views, 0);
  SparseTracks chosen;
  for (const size_t i : order) {
    const auto seen = tracks.observations[i];
    const bool is_wanted =
        seen.size() >= 2 &&
        std::any_of(seen.begin(), seen.end(), [&](const auto& observation) {
          return counts[observation.view] < min_observations_per_view;
        });
    if (is_wanted) {
      chosen.positions.push_back(tracks.positions[i]);
      chosen.observations.AddRow(seen);
      for (const TrackObservation& observation : seen) {
        ++counts[observation.view];
      }
    }
  }
  return chosen;
}

std::vector<Eigen::Vector3d> LocateTracks(const SparseTracks& tracks,
                                          const std::vector<View>& views,
                                          const std::vector<double>& sigmas,
                                          double point_sigma) {
  constexpr int kIterations = 10;
  std::vector<Eigen::Vector3d> positions = tracks.positions;
  tbb::parallel_for(size_t{0}, positions.size(), [&](size_t i) {
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      PointEquations equations;
      for (const TrackObservation& seen : tracks.observations[i]) {
        equations.Add(views[seen.view], seen, sigmas[seen.view], positions[i]);
      }
      if (!(equations.footprint > 0)) {
        return;
      }
      const double scale = point_sigma * equations.footprint;
      equations.matrix.diagonal().array() += 1 / (scale * scale);
      equations.gradient +=
          (positions[i] - tracks.positions[i]) / (scale * scale);
      positions[i] -= equations.matrix.ldlt().solve(equations.gradient);
    }
  });
  return positions;
}

}  // namespace colmap_ext
