#include <algorithm>
#include <filesystem>
#include <vector>

#include "tests/formats/test_files.h"
#include "tests/synthetic/write_workspace.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/image_order.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace sparse_model_agreement_test {

class SparseModelAgreementTest : public testing::Test {
 protected:
  SparseModelAgreementTest() {
    sphere_.points.resize(20);
    sphere_.point_images.assign(20, {0, 2});
    const std::filesystem::path old = folder_.Path() / "old";
    sphere_.WriteModel(old, ".bin");
    std::filesystem::create_directory(binary_);
    synthetic::ConvertModel(old.string(), binary_.string());
  }

  SphereWorkspace sphere_;
  TemporaryFolder folder_;
  // As this COLMAP writes it: with rigs and frames from 3.12 on.
  std::filesystem::path binary_ = folder_.Path() / "binary";
};

// What COLMAP itself writes and reads is what we read.
TEST_F(SparseModelAgreementTest, ReadsWhatThisColmapWrites) {
  const SparseModel model = ReadSparseModel(binary_);
  const std::vector<View> views = synthetic::ReadViews(binary_.string());
  ASSERT_EQ(model.images.size(), views.size());
  for (const View& view : views) {
    const auto image = std::find_if(
        model.images.begin(), model.images.end(),
        [&](const SparseImage& other) { return other.name == view.name; });
    ASSERT_NE(image, model.images.end()) << view.name;
    EXPECT_TRUE(image->cam_from_world_rotation.toRotationMatrix().isApprox(
        view.cam_from_world_rotation));
    EXPECT_TRUE(image->cam_from_world_translation.isApprox(
        view.cam_from_world_translation));
    const SparseCamera& camera = model.cameras.at(image->camera_id);
    EXPECT_EQ(camera.fx, view.fx);
    EXPECT_EQ(camera.cy, view.cy);
    EXPECT_EQ(camera.width, view.width);
  }
  EXPECT_EQ(model.point_positions.size(), 2);  // of 20, in the sphere's model
  const bool has_frames = std::filesystem::exists(binary_ / "frames.bin");
  EXPECT_EQ(model.frames.size(), has_frames ? views.size() : 0);
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  EXPECT_TRUE(has_frames);
#endif
}

// The order that this COLMAP counts images by in a .vis is one of those that
// are tried, under the name that its version has in our reports.
TEST_F(SparseModelAgreementTest, KnowsTheImageOrderOfThisColmap) {
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  constexpr ImageOrderKind kKind = ImageOrderKind::kFrame;
#elif COLMAP_EXT_COLMAP_VERSION >= 31100
  constexpr ImageOrderKind kKind = ImageOrderKind::kImageId;
#else
  constexpr ImageOrderKind kKind = ImageOrderKind::kFile;
#endif
  const SparseModel model = ReadSparseModel(binary_);
  const std::vector<View> views = synthetic::ReadViews(binary_.string());
  const std::vector<ImageOrder> orders = CandidateImageOrders(model);
  const auto order =
      std::find_if(orders.begin(), orders.end(),
                   [](const ImageOrder& other) { return other.kind == kKind; });
  ASSERT_NE(order, orders.end());
  ASSERT_EQ(order->images.size(), views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(model.images[order->images[i]].name, views[i].name);
  }
}

}  // namespace sparse_model_agreement_test
}  // namespace colmap_ext
