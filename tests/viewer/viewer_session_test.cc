#include "viewer/viewer_session.h"

#include <set>

#include <gtest/gtest.h>

#include "scene/view.h"

namespace colmap_ext::viewer_session_test {

// A square in the plane z = 0 that two cameras see.
class ViewerSessionTest : public testing::Test {
 protected:
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

  Eigen::Vector3d Eye() const { return session_.Picture()->Center(); }

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
  for (const KeyAction& action : KeyActions()) {
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

}  // namespace colmap_ext::viewer_session_test
