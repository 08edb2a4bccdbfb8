#include "viewer/viewer_session.h"

#include <future>
#include <new>
#include <numbers>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "viewer/background_worker.h"

namespace colmap_ext::viewer_session_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A square in the plane z = 0 that two cameras see.
struct ViewerSessionTest : testing::Test {
  ViewerSessionTest() {
    auto mesh = std::make_shared<ShownMesh>();
    mesh->mesh = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                  {{0, 1, 2}, {0, 2, 3}}};
    mesh->views = Rows<uint32_t>({0, 2, 4, 5, 5}, {0, 1, 0, 1, 1});
    mesh->name = "square";
    View b = LookAtView({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 64, 48, 80);
    b.name = "b";
    View a = LookAtView({1, 0, 4}, {0, 0, 0}, {0, 1, 0}, 64, 48, 70);
    a.name = "a";
    inbox_.Put("mesh", [mesh](ShownScene* scene) {
      scene->meshes = {mesh, std::make_shared<const ShownMesh>(*mesh)};
    });
    inbox_.Put("views", [a, b](ShownScene* scene) { scene->views = {b, a}; });
    session_.SetSize(640, 480);
    EXPECT_FALSE(session_.Picture());
    EXPECT_TRUE(session_.Update(0));
    EXPECT_FALSE(session_.Update(0.1));
  }

  ViewerHost Host() {
    ViewerHost host;
    host.load_image = [this](size_t index, const View& /*view*/) {
      loaded_.push_back(index);
    };
    host.pause = [this](bool is_paused) { is_paused_ = is_paused; };
    return host;
  }

  Vector3d Eye() const { return session_.Picture()->Center(); }

  // Presses a key and waits until a flight has ended.
  void Press(int key) {
    session_.Press(key);
    session_.Update(now_ += 1);
    session_.Update(now_ += 1);
    EXPECT_FALSE(session_.IsFlying());
  }

  SceneInbox inbox_;
  std::vector<size_t> loaded_;
  bool is_paused_ = false;
  ViewerSession session_{&inbox_, Host(), {}};
  double now_ = 0;
};

TEST_F(ViewerSessionTest, CamerasComeByNameWithTheirIntrinsics) {
  Press(kKeyRight);
  EXPECT_NEAR(Eye().x(), 1, 1e-9);  // "a"
  EXPECT_DOUBLE_EQ(session_.Picture()->fx, 700);
  Press(']');
  EXPECT_NEAR(Eye().z(), 3, 1e-9);  // "b"
  Press('[');
  EXPECT_NEAR(Eye().x(), 1, 1e-9);
  Press(kKeyLeft);
  EXPECT_NEAR(Eye().z(), 3, 1e-9);
}

TEST_F(ViewerSessionTest, ImagesBelongToTheirCameras) {
  Press('G');
  EXPECT_FALSE(session_.Settings().image);
  Press(kKeyRight);
  Press('G');
  EXPECT_EQ(session_.Settings().image, 1);
  EXPECT_EQ(loaded_, std::vector<size_t>{1});
  const double opacity = session_.Settings().image_opacity;
  Press('+');
  EXPECT_GT(session_.Settings().image_opacity, opacity);
  Press(kKeyRight);
  EXPECT_EQ(session_.Settings().image, 0);
  session_.Drag(DragKind::kRotate, {300, 200}, {310, 200});
  EXPECT_FALSE(session_.Settings().image);
}

TEST_F(ViewerSessionTest, ResetBringsTheFirstViewBack) {
  const View first = *session_.Picture();
  session_.Drag(DragKind::kRotate, {300, 200}, {390, 220});
  session_.Drag(DragKind::kPan, {300, 200}, {390, 220});
  session_.Scroll(2);
  EXPECT_GT((Eye() - first.Center()).norm(), 0.1);
  Press('R');
  EXPECT_NEAR((Eye() - first.Center()).norm(), 0, 1e-9);
}

TEST_F(ViewerSessionTest, PickedFacesTellTheirViews) {
  session_.Pick(0);
  ASSERT_TRUE(session_.GetPicked());
  EXPECT_EQ(session_.GetPicked()->views, (std::vector<uint32_t>{0, 1}));
  ASSERT_TRUE(session_.GetPicked()->pair);
  EXPECT_EQ(*session_.GetPicked()->pair, (ViewPair{0, 1}));  // the nearer first
  Press(kKeyTab);
  EXPECT_FALSE(session_.GetPicked());
  EXPECT_EQ(session_.Settings().mesh, 1);
  session_.Pick(2);
  EXPECT_FALSE(session_.GetPicked());
}

TEST_F(ViewerSessionTest, PausesOnlyWhatCanBePaused) {
  Press('T');
  EXPECT_TRUE(is_paused_);
  Press('T');
  EXPECT_FALSE(is_paused_);
  ViewerSession other(&inbox_, {}, {});
  other.Press('T');
  EXPECT_FALSE(is_paused_);
}

TEST_F(ViewerSessionTest, EveryKeyHasOneActionAndDoesNoHarmWithoutAScene) {
  std::set<int> keys;
  for (const KeyAction& action : ViewerSession::KeyActions()) {
    EXPECT_NE(std::string(action.help), "");
    for (const int key : action.keys) {
      EXPECT_TRUE(keys.insert(key).second) << action.name;
    }
  }
  SceneInbox empty;
  ViewerSession session(&empty, {}, {});
  for (const int key : keys) {
    session.Press(key);
    session.Update(1);
  }
  session.Scroll(1);
  session.Pick(3);
  session.Drag(DragKind::kPan, {0, 0}, {1, 1});
  EXPECT_TRUE(session.IsClosed());
}

constexpr int kWidth = 640;
constexpr int kHeight = 480;

View Somewhere() {
  return LookAtView({3, -2, 1.5}, {0.2, 0.1, -0.3}, {0, 0, 1}, kWidth, kHeight,
                    700);
}

Vector2d Pixel(const View& view, const Vector3d& point) {
  return view.ImageFromCam(view.CamFromWorld(point));
}

bool IsRotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-9) &&
         matrix.determinant() > 0;
}

TEST(OrbitCamera, SeesAllOfItsViewWithItsIntrinsics) {
  const View view = Somewhere();
  const OrbitCamera camera(view, {0, 0, 0});
  const View same = camera.Picture(kWidth, kHeight);
  EXPECT_DOUBLE_EQ(same.fx, view.fx);
  EXPECT_DOUBLE_EQ(same.cx, view.cx);
  EXPECT_DOUBLE_EQ(same.cy, view.cy);
  const View wide = camera.Picture(2 * kWidth, kHeight);
  EXPECT_DOUBLE_EQ(wide.fx, view.fx);
  EXPECT_DOUBLE_EQ(wide.cx, view.cx + 0.5 * kWidth);
}

TEST(OrbitCamera, OrbitingKeepsThePivotInItsPixelAndItsDistance) {
  const Vector3d pivot(0.3, -0.2, 0.1);
  OrbitCamera camera(Somewhere(), pivot);
  const Vector2d before = Pixel(camera.Picture(kWidth, kHeight), pivot);
  const double distance = (Somewhere().Center() - pivot).norm();
  for (const Vector2d& to :
       {Vector2d(400, 100), Vector2d(10, 470), Vector2d(-50, 900)}) {
    camera.Orbit({300, 250}, to, kWidth, kHeight);
    const View view = camera.Picture(kWidth, kHeight);
    EXPECT_TRUE(IsRotation(view.cam_from_world_rotation));
    EXPECT_NEAR((Pixel(view, pivot) - before).norm(), 0, 1e-6);
    EXPECT_NEAR((view.Center() - pivot).norm(), distance, 1e-9);
  }
}

TEST(OrbitCamera, TheSurfaceFollowsTheFinger) {
  const Vector3d pivot(0.2, 0.1, -0.3);
  OrbitCamera camera(Somewhere(), pivot);
  const View before = camera.Picture(kWidth, kHeight);
  // A point before the pivot, seen in the middle.
  const Vector3d point = pivot + 0.2 * (before.Center() - pivot).normalized();
  camera.Orbit({320, 240}, {350, 240}, kWidth, kHeight);
  const View right = camera.Picture(kWidth, kHeight);
  EXPECT_GT(Pixel(right, point).x(), Pixel(before, point).x() + 1);
  camera.Orbit({320, 240}, {320, 200}, kWidth, kHeight);
  EXPECT_LT(Pixel(camera.Picture(kWidth, kHeight), point).y(),
            Pixel(right, point).y() - 1);
}

TEST(OrbitCamera, PanningMovesThePivotWithTheMouse) {
  const Vector3d pivot(0.2, 0.1, -0.3);
  OrbitCamera camera(Somewhere(), pivot);
  const Vector2d before = Pixel(camera.Picture(800, 300), pivot);
  camera.Pan({100, 100}, {130, 80}, 800, 300);
  EXPECT_NEAR(
      (Pixel(camera.Picture(800, 300), pivot) - before - Vector2d(30, -20))
          .norm(),
      0, 1e-6);
  // What it turns around is still in the middle of what is seen.
  EXPECT_NEAR((Pixel(camera.Picture(800, 300), camera.Pivot()) - before).norm(),
              0, 1e-6);
}

TEST(OrbitCamera, ZoomingBackAndForthOrAFullTurnIsNothing) {
  OrbitCamera camera(Somewhere(), {0, 0, 0});
  const double distance = Somewhere().Center().norm();
  camera.Zoom(3);
  const double near = camera.Picture(kWidth, kHeight).Center().norm();
  EXPECT_LT(near, distance);
  EXPECT_GT(near, 0);
  camera.Zoom(-3);
  EXPECT_NEAR(
      (camera.Picture(kWidth, kHeight).Center() - Somewhere().Center()).norm(),
      0, 1e-9);
  OrbitCamera turned(Somewhere(), {1, 2, 3});
  for (int i = 0; i < 12; ++i) {
    turned.Turn(std::numbers::pi / 6, {1, 1, 0});
  }
  EXPECT_TRUE(turned.Picture(kWidth, kHeight)
                  .cam_from_world_rotation.isApprox(
                      Somewhere().cam_from_world_rotation, 1e-9));
}

TEST(BetweenViews, StartsAndEndsAtTheViews) {
  const View first = Somewhere();
  View second =
      LookAtView({-1, 4, 2}, {0, 0, 0}, {0, 0, 1}, kWidth, kHeight, 500);
  second.cx = 300;
  const View start = BetweenViews(first, second, 0);
  EXPECT_NEAR((start.Center() - first.Center()).norm(), 0, 1e-9);
  const View end = BetweenViews(first, second, 1);
  EXPECT_EQ(end.cam_from_world_rotation, second.cam_from_world_rotation);
  EXPECT_EQ(end.cx, second.cx);
  const View middle = BetweenViews(first, second, 0.5);
  EXPECT_TRUE(IsRotation(middle.cam_from_world_rotation));
  EXPECT_NEAR((middle.Center() - first.Center()).norm(),
              (middle.Center() - second.Center()).norm(), 1e-9);
}

TEST(PivotBefore, LiesOnTheAxis) {
  const View view = Somewhere();
  for (const Vector3d& point : {Vector3d(0, 0, 0), Vector3d(9, -6, 4)}) {
    const Vector3d pivot = PivotBefore(view, point);
    EXPECT_NEAR((Pixel(view, pivot) - Vector2d(view.cx, view.cy)).norm(), 0,
                1e-6);
    EXPECT_GT(view.CamFromWorld(pivot).z(), 0);
  }
}

struct BackgroundWorkerTest : testing::Test {
  // Returns when all jobs are done.
  void Finish() {
    std::promise<void> done;
    worker_.Add([&] { done.set_value(); });
    done.get_future().wait();
  }

  std::string log_;  // changed by the worker's thread alone
  BackgroundWorker worker_{[this](const std::exception& error) {
    log_ += error.what();
    if (log_ == "last straw") {
      throw std::bad_alloc();
    }
  }};
};

TEST_F(BackgroundWorkerTest, SaysWhatJobsThrowAndGoesOn) {
  worker_.Add([] { throw std::runtime_error("no image"); });
  worker_.Add([this] { log_ += ", a mesh"; });
  Finish();
  EXPECT_EQ(log_, "no image, a mesh");
}

TEST_F(BackgroundWorkerTest, GoesOnWhereItCanNotEvenSayWhatIsWrong) {
  worker_.Add([] { throw std::runtime_error("last straw"); });
  worker_.Add([] { throw 7; });
  worker_.Add([this] { log_ += ", done"; });
  Finish();
  EXPECT_EQ(log_, "last straw, done");
}

TEST_F(BackgroundWorkerTest, OfUrgentJobsOfAKindThatWaitTheLastIsDone) {
  std::promise<void> start;
  std::promise<void> gate;
  worker_.Add([&] {
    start.set_value();
    gate.get_future().wait();
  });
  start.get_future().wait();
  worker_.Add([this] { log_ += " last"; });
  for (const char* name : {" a1", " a2", " a3"}) {
    worker_.AddUrgent("a", [this, name] { log_ += name; });
  }
  worker_.AddUrgent("b", [this] { log_ += " b"; });
  gate.set_value();
  Finish();
  EXPECT_EQ(log_, " b a3 last");
}

}  // namespace colmap_ext::viewer_session_test
