#include "cameras/refine_cameras.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Geometry>

#include "cameras/camera_set.h"
#include "tests/cameras/camera_scene.h"
#include "tests/threads.h"

namespace colmap_ext::refine_cameras_test {

const CameraScene& Scene() {
  static const CameraScene scene = MakeCameraScene();
  return scene;
}

CameraRefinementOptions Poses() {
  CameraRefinementOptions options;
  options.parts = RefinedParts::kPoses;
  return options;
}

// Poses that a seed disturbs by half a pixel.
CameraSet Start(uint64_t seed) {
  return Disturb(Scene(), Scene().truth, 0.5, seed);
}

RefinedCameras Refine(const CameraSet& start,
                      const CameraRefinementOptions& options = Poses()) {
  return Scene().Refine(options, start, Scene().tracks);
}

// Px, see Distance().
double DistanceToTruth(const RefinedCameras& refined, int view = -1) {
  return Distance(Scene(), refined.cameras, Scene().truth, view);
}

TEST(RefineCameras, BringsDisturbedPosesBack) {
  const RefinedCameras refined = Refine(Start(3));
  EXPECT_LT(DistanceToTruth(refined), 0.05);
  EXPECT_GT(refined.report.mean_zncc, refined.report.mean_zncc_before);
  for (size_t i = 0; i < refined.cameras.views.size(); ++i) {
    EXPECT_EQ(refined.cameras.views[i].fx, Scene().truth.views[i].fx);
    EXPECT_EQ(refined.cameras.views[i].cx, Scene().truth.views[i].cx);
  }
}

TEST(RefineCameras, LeavesExactPosesWhereTheyAre) {
  EXPECT_LT(DistanceToTruth(Refine(Scene().truth)), 0.03);
}

// Px, between where a rig has the views of a frame and where they are.
double RigError(const CameraSet& cameras) {
  CameraSet rigid = cameras;
  FollowLeaders({Scene().truth.views, cameras.view_cameras, cameras.leaders},
                &rigid.views);
  return Distance(Scene(), cameras, rigid);
}

TEST(RefineCameras, RigsMoveAsTheyAre) {
  CameraSet start = Start(3);
  start.leaders = {0, 1, 0, 1, 4, 4, 6, 4};
  EXPECT_GT(RigError(start), 0.1);
  FollowLeaders({Scene().truth.views, start.view_cameras, start.leaders},
                &start.views);
  EXPECT_LT(RigError(start), 1e-9);
  ASSERT_GT(Distance(Scene(), start, Scene().truth), 0.2);
  const RefinedCameras refined = Refine(start);
  EXPECT_LT(RigError(refined.cameras), 1e-9);
  EXPECT_LT(DistanceToTruth(refined), 0.05);
  // With intrinsics too.
  CameraRefinementOptions options = Poses();
  options.parts = RefinedParts::kPosesIntrinsics;
  const RefinedCameras all = Refine(start, options);
  EXPECT_LT(RigError(all.cameras), 1e-9);
  EXPECT_LT(DistanceToTruth(all), 0.05);
}

// A view without texture and features goes where its rig goes.
TEST(RefineCameras, RigsTakeBlindViewsAlong) {
  CameraScene scene = Scene();
  SparseTracks tracks;
  for (size_t i = 0; i < scene.tracks.positions.size(); ++i) {
    tracks.positions.push_back(scene.tracks.positions[i]);
    for (const TrackObservation& seen : scene.tracks.observations[i]) {
      if (seen.view != 3) {
        tracks.observations.values.push_back(seen);
      }
    }
    tracks.observations.EndRow();
  }
  std::erase_if(scene.pairs, [](const ViewPair& pair) {
    return pair.first == 3 || pair.second == 3;
  });
  CameraSet start = Start(3);
  start.leaders = {0, 1, 2, 2, 4, 5, 6, 7};
  FollowLeaders({scene.truth.views, start.view_cameras, start.leaders},
                &start.views);
  const RefinedCameras refined = scene.Refine(Poses(), start, tracks);
  EXPECT_EQ(refined.report.views[3].num_windows, 0);
  EXPECT_LT(RigError(refined.cameras), 1e-9);
  EXPECT_LT(DistanceToTruth(refined, 3), 0.1);
  EXPECT_LT(DistanceToTruth(refined), 0.05);
}

TEST(RefineCameras, NeedsNoFeatures) {
  const RefinedCameras refined = Scene().Refine(Poses(), Start(3), {});
  // The gauge is that of the disturbed cameras then.
  EXPECT_LT(DistanceToTruth(refined), 0.3);
  EXPECT_GT(refined.report.mean_zncc, refined.report.mean_zncc_before + 0.01);
}

TEST(RefineCameras, BringsASharedFocalLengthBack) {
  CameraSet start = Disturb(Scene(), Scene().truth, 0.3, 4);
  for (View& view : start.views) {
    view = MoveView(view, PoseStep::Zero(), {std::log(1.002), 0, 0});
  }
  CameraRefinementOptions options = Poses();
  options.parts = RefinedParts::kPosesIntrinsics;
  const RefinedCameras refined = Refine(start, options);
  EXPECT_LT(DistanceToTruth(refined), 0.05);
  for (const View& view : refined.cameras.views) {
    EXPECT_EQ(view.fx, refined.cameras.views[0].fx);
    EXPECT_EQ(view.cx, refined.cameras.views[0].cx);
  }
}

TEST(RefineCameras, ImagesOfTheirOwnCamerasHaveTheirOwnIntrinsics) {
  const CameraScene scene = MakeCameraScene(true);
  CameraSet start = scene.truth;
  start.views[2] =
      MoveView(start.views[2], PoseStep::Zero(), {std::log(1.003), 0, 0});
  CameraRefinementOptions options = Poses();
  options.parts = RefinedParts::kPosesIntrinsics;
  const RefinedCameras refined = scene.Refine(options, start, scene.tracks);
  EXPECT_LT(Distance(scene, refined.cameras, scene.truth), 0.05);
  EXPECT_NE(refined.cameras.views[2].fx, refined.cameras.views[1].fx);
}

// Far beyond what windows can follow: its features bring it back.
TEST(RefineCameras, OneBadImageIsBroughtBackAndDoesNoHarm) {
  CameraSet start = Scene().truth;
  PoseStep step;
  step << 0.05, -0.03, 0.02, 0, 0, 0;
  start.views[3] = MoveView(start.views[3], step, IntrinsicsStep::Zero());
  ASSERT_GT(Distance(Scene(), start, Scene().truth, 3), 5);
  CameraRefinementOptions options = Poses();
  options.max_rounds = 8;
  const RefinedCameras refined = Refine(start, options);
  EXPECT_LT(DistanceToTruth(refined, 3), 0.2);
  for (int i = 0; i < 8; ++i) {
    EXPECT_LT(DistanceToTruth(refined, i), 0.2) << i;
  }
}

TEST(RefineCameras, ImagesWithoutTextureAndFeaturesRest) {
  CameraScene scene = Scene();
  std::ranges::fill(scene.scene.images[1].pixels, 100);
  SparseTracks tracks;
  for (size_t i = 0; i < scene.tracks.positions.size(); ++i) {
    for (const TrackObservation& seen : scene.tracks.observations[i]) {
      if (seen.view != 1) {
        tracks.observations.values.push_back(seen);
      }
    }
    tracks.observations.EndRow();
    tracks.positions.push_back(scene.tracks.positions[i]);
  }
  const CameraSet start = Disturb(scene, scene.truth, 0.3, 6);
  const RefinedCameras refined = scene.Refine(Poses(), start, tracks);
  EXPECT_TRUE(refined.report.views[1].is_skipped);
  EXPECT_LT(Distance(scene, refined.cameras, start, 1), 0.1);
  EXPECT_LT(Distance(scene, refined.cameras, scene.truth, 0), 0.05);
}

TEST(RefineCameras, TwoImagesAreEnough) {
  CameraScene scene = Scene();
  scene.pairs = {scene.pairs.front()};
  const auto [a, b] = scene.pairs.front();
  const CameraSet start = Disturb(scene, scene.truth, 0.5, 7);
  const RefinedCameras refined = scene.Refine(Poses(), start, {});
  EXPECT_GT(refined.report.views[a].num_windows, 20u);
  EXPECT_GT(refined.report.mean_zncc, refined.report.mean_zncc_before);
  for (size_t i = 0; i < start.views.size(); ++i) {
    if (i != a && i != b) {
      EXPECT_TRUE(refined.report.views[i].is_skipped);
      EXPECT_TRUE(refined.cameras.views[i].cam_from_world_rotation ==
                  start.views[i].cam_from_world_rotation);
    }
  }
}

// A scene that is turned, scaled and moved gives the same cameras, turned,
// scaled and moved.
TEST(RefineCameras, FollowsTheWorldsFrame) {
  const Similarity similarity{
      3.5,
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized())
          .toRotationMatrix(),
      {0.5, -2, 1}};
  const CameraSet start = Start(8);
  const RefinedCameras refined = Refine(start);

  CameraScene moved = Scene();
  for (Eigen::Vector3f& vertex : moved.scene.dense.scene.surface.vertices) {
    vertex = similarity(vertex.cast<double>()).cast<float>();
  }
  CameraSet moved_start = start;
  for (View& view : moved_start.views) {
    view = TransformView(similarity, view);
  }
  for (Eigen::Vector3d& position : moved.tracks.positions) {
    position = similarity(position);
  }
  const RefinedCameras moved_refined =
      moved.Refine(Poses(), moved_start, moved.tracks);
  CameraSet expected = refined.cameras;
  for (View& view : expected.views) {
    view = TransformView(similarity, view);
  }
  EXPECT_LT(Distance(moved, moved_refined.cameras, expected), 0.01);
}

// The sparse model's points lie, on the whole, where they lay.
TEST(RefineCameras, KeepsTheGauge) {
  const RefinedCameras refined = Refine(Start(9));
  const std::vector<double> footprints(refined.positions.size(),
                                       Scene().scene.dense.scene.footprint);
  const Similarity left =
      AlignPoints(refined.positions, Scene().tracks.positions, footprints,
                  /*has_scale=*/true);
  for (const Eigen::Vector3d& position : refined.positions) {
    EXPECT_LT((left(position) - position).norm(), 0.02 * footprints[0]);
  }
}

TEST(RefineCameras, DoesNotDependOnTheNumberOfThreads) {
  const CameraSet start = Start(10);
  ExpectSameForAnyThreads([&] {
    const RefinedCameras refined = Refine(start);
    std::vector<Eigen::Vector3d> all = refined.positions;
    for (const View& view : refined.cameras.views) {
      all.push_back(view.cam_from_world_translation);
      all.push_back(view.Center());
    }
    return all;
  });
}

// The scene with its views in another order, each paired with its two neighbors
// around the statue.
CameraScene Shuffled(const std::vector<uint32_t>& order) {
  CameraScene shuffled = Scene();
  const auto size = static_cast<uint32_t>(order.size());
  std::vector<uint32_t> places(size);
  for (uint32_t i = 0; i < size; ++i) {
    places[order[i]] = i;
    shuffled.truth.views[i] = Scene().truth.views[order[i]];
    shuffled.scene.dense.scene.views[i] = shuffled.truth.views[i];
    shuffled.scene.images[i] = Scene().scene.images[order[i]];
  }
  for (TrackObservation& seen : shuffled.tracks.observations.values) {
    seen.view = places[seen.view];
  }
  shuffled.pairs.clear();
  for (uint32_t i = 0; i < size; ++i) {
    const uint32_t a = places[i];
    const uint32_t b = places[(i + 1) % size];
    shuffled.pairs.push_back({std::min(a, b), std::max(a, b)});
  }
  return shuffled;
}

// Half of the buffers fit into memory, and the views come in any order.
TEST(RefineCameras, DrawsViewsAboutOnceAPassWhereFewFit) {
  const tbb::global_control one_thread(
      tbb::global_control::max_allowed_parallelism, 1);
  const CameraScene scene = Shuffled({0, 3, 6, 1, 4, 7, 2, 5});
  const View& view = scene.truth.views[0];
  const TriangleMesh& mesh = scene.scene.Truth();
  const size_t of_view = static_cast<size_t>(8) * view.width * view.height +
                         mesh.facets.size() / 8;
  size_t num_drawn = 0;
  const VisibilityBuffers buffers(mesh, scene.truth.views, 0.1, 4 * of_view,
                                  [&](size_t) {
                                    ++num_drawn;
                                    return std::shared_ptr<const GrayImage>();
                                  });
  const auto images = scene.scene.Pyramid();
  const RefinedCameras refined = RefineCameras(
      Poses(), {{}, scene.tracks, buffers, scene.pairs, images.get()},
      scene.truth, scene.truth);
  EXPECT_GT(refined.report.num_windows, 100);
  const size_t num_passes = 1 + refined.report.num_rounds;
  EXPECT_LE(num_drawn, 1.5 * 8 * static_cast<double>(num_passes));
}

// Cameras in a row before a wall, each of whose points the next ones see, too:
// so many that the sparse solver is chosen.
struct LongRow {
  explicit LongRow(size_t num_views) {
    Random random(1);
    for (size_t i = 0; i < num_views; ++i) {
      View view{"", 0, 0, 500, 500, 250, 250};
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

// By the dense solver and by the sparse one.
TEST(SolveCameras, BringsViewsBackWithTheSameBytesByAnyThreads) {
  for (const size_t num_views : {12, 320}) {
    const LongRow row(num_views);
    const CameraEstimate solved = row.Solve();
    EXPECT_GT(row.Error(row.start, row.tracks.positions), 0.3);
    EXPECT_LT(row.Error(solved.cameras, solved.positions), 0.01);
    ExpectSameForAnyThreads([&] {
      const CameraEstimate estimate = row.Solve();
      std::vector<Eigen::Vector3d> numbers = estimate.positions;
      for (const View& view : estimate.cameras.views) {
        numbers.push_back(view.cam_from_world_translation);
        numbers.push_back(view.cam_from_world_rotation.col(0));
        numbers.push_back(view.cam_from_world_rotation.col(1));
      }
      return numbers;
    });
  }
}

}  // namespace colmap_ext::refine_cameras_test
