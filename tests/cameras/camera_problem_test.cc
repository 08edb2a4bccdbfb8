#include "cameras/camera_problem.h"

#include <dlfcn.h>

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace camera_problem_test {

// Cameras in a row before a wall, each of whose points the next ones see, too:
// so many that the sparse solver is chosen.
struct LongRow {
  explicit LongRow(size_t num_views) {
    Random random(1);
    for (size_t i = 0; i < num_views; ++i) {
      View view;
      view.fx = view.fy = 500;
      view.cx = view.cy = 250;
      view.cam_from_world_translation.x() = -static_cast<double>(i);
      truth.views.push_back(view);
      truth.view_cameras.push_back(0);
    }
    for (uint32_t i = 0; i + 4 <= num_views; ++i) {
      for (int k = 0; k < 12; ++k) {
        const Eigen::Vector3d point(i + 3 * random.Unit(),
                                    4 * random.Unit() - 2, 5 + random.Unit());
        tracks.positions.push_back(point);
        for (uint32_t view = i; view < i + 4; ++view) {
          const View& seen_by = truth.views[view];
          tracks.observations.values.push_back(
              {view, seen_by.ImageFromCam(seen_by.CamFromWorld(point))});
        }
        tracks.observations.EndRow();
      }
    }
    start = truth;
    for (View& view : start.views) {
      PoseStep step;
      for (int k = 0; k < 6; ++k) {
        step[k] = 2e-3 * (random.Unit() - 0.5);
      }
      view = MoveView(view, step, IntrinsicsStep::Zero());
    }
  }

  CameraEstimate Solve() const {
    const CameraEvidence evidence = {
        .shifts = {},
        .tracks = tracks,
        .depths = std::vector<double>(truth.views.size(), 5.5),
        .track_sigmas = std::vector<double>(truth.views.size(), 0.5),
        .is_skipped = std::vector<uint8_t>(truth.views.size(), 0),
        .priors = {}};
    CameraEstimate estimate = {start, {}, tracks.positions};
    EXPECT_TRUE(SolveCameras(evidence, start, &estimate));
    return estimate;
  }

  // Root mean square of the reprojection errors, px.
  double Error(const CameraSet& cameras,
               const std::vector<Eigen::Vector3d>& positions) const {
    double sum = 0;
    for (size_t i = 0; i < positions.size(); ++i) {
      for (const TrackObservation& seen : tracks.observations[i]) {
        const View& view = cameras.views[seen.view];
        sum += (view.ImageFromCam(view.CamFromWorld(positions[i])) - seen.pixel)
                   .squaredNorm();
      }
    }
    return std::sqrt(sum /
                     static_cast<double>(tracks.observations.values.size()));
  }

  CameraSet truth;
  CameraSet start;
  SparseTracks tracks;
};

// Sets the threads of what libraries of linear algebra are loaded.
void SetLibraryThreads(int num_threads) {
  for (const char* name : {"omp_set_num_threads", "openblas_set_num_threads"}) {
    if (void* set = dlsym(RTLD_DEFAULT, name)) {
      reinterpret_cast<void (*)(int)>(set)(num_threads);
    }
  }
}

TEST(SolveCameras, ManyViewsAreBroughtBackWithTheSameBytesByAnyThreads) {
  const LongRow row(320);
  SetLibraryThreads(1);
  const CameraEstimate one = row.Solve();
  SetLibraryThreads(4);
  const CameraEstimate four = row.Solve();
  EXPECT_GT(row.Error(row.start, row.tracks.positions), 0.3);
  EXPECT_LT(row.Error(one.cameras, one.positions), 0.01);
  EXPECT_EQ(one.positions, four.positions);
  for (size_t i = 0; i < row.truth.views.size(); ++i) {
    EXPECT_EQ(one.cameras.views[i].cam_from_world_rotation,
              four.cameras.views[i].cam_from_world_rotation);
    EXPECT_EQ(one.cameras.views[i].cam_from_world_translation,
              four.cameras.views[i].cam_from_world_translation);
  }
}

}  // namespace camera_problem_test
}  // namespace colmap_ext
