#include "workspace/image_order.h"

#include <algorithm>

#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/workspace.h"

namespace colmap_ext::image_order_test {

using Indices = std::vector<size_t>;

class ImageOrderTest : public FolderTest {
 protected:
  // The order that is found in a workspace whose .vis counts as vis_order.
  VerifiedOrder Find(const Indices& vis_order,
                     std::optional<ImageOrderKind> wanted = std::nullopt) {
    sphere_.vis_order = vis_order;
    std::filesystem::remove_all(path_ / "sparse");
    sphere_.Write(path_);
    const SparseModel model = ReadSparseModel(path_ / "sparse");
    const PlyCloud cloud = ReadPlyCloud(path_ / "fused.ply");
    const Visibility visibility =
        ReadVisibility(path_ / "fused.ply.vis", cloud.positions.size());
    const Views views = ReadViews(path_, model, {}, decoder_);
    return FindImageOrder({cloud, visibility, model, views.views,
                           path_ / "images", decoder_, path_ / "fused.ply.vis"},
                          wanted);
  }

  template <typename Function>
  static std::optional<Alternative> AlternativeTo(Function function) {
    try {
      function();
    } catch (const FileError& error) {
      return error.GetAlternative();
    }
    return std::nullopt;
  }

  // The images have the ids 4, 9, 2, 7, 5, 1, 8, in the order of the file.
  const Indices file_order_ = {0, 1, 2, 3, 4, 5, 6};
  const Indices id_order_ = {5, 2, 0, 4, 3, 6, 1};
  PictureDecoder decoder_ = NetpbmDecoder();
  SphereWorkspace sphere_;
};

TEST_F(ImageOrderTest, FindsTheOrderOfEachVersionOfColmap) {
  const VerifiedOrder file = Find(file_order_);
  EXPECT_EQ(file.order.kind, ImageOrderKind::kFile);
  EXPECT_EQ(file.order.images, file_order_);
  EXPECT_EQ(file.evidence.inside, 1);
  EXPECT_EQ(file.evidence.facing, 1);
  const VerifiedOrder by_id = Find(id_order_);
  EXPECT_EQ(by_id.order.kind, ImageOrderKind::kImageId);
  EXPECT_EQ(by_id.order.images, id_order_);

  sphere_.frames = {{8, 4}, {9, 7, 1}, {2}, {5}};
  const Indices frame_order = {6, 0, 1, 3, 5, 2, 4};
  EXPECT_EQ(Find(frame_order).order.kind, ImageOrderKind::kFrame);
  EXPECT_EQ(Find(frame_order).order.images, frame_order);
  EXPECT_EQ(Find(id_order_).order.kind, ImageOrderKind::kImageId);
}

TEST_F(ImageOrderTest, FindsItByColorsWhereNormalsAreMissing) {
  sphere_.write_normals = false;
  for (const Indices& order : {file_order_, id_order_}) {
    const VerifiedOrder found = Find(order);
    EXPECT_EQ(found.order.images, order);
    EXPECT_EQ(found.reason, OrderReason::kColors);
  }
}

TEST_F(ImageOrderTest, RefusesToGuess) {
  sphere_.write_normals = false;
  sphere_.write_images = false;
  EXPECT_EQ(AlternativeTo([&] { Find(id_order_); }),
            Alternative::kSayImageOrder);
  const VerifiedOrder wanted = Find(id_order_, ImageOrderKind::kImageId);
  EXPECT_EQ(wanted.order.images, id_order_);
  EXPECT_EQ(wanted.reason, OrderReason::kWanted);
  EXPECT_EQ(AlternativeTo([&] { Find(id_order_, ImageOrderKind::kFrame); }),
            Alternative::kOtherImageOrder);
}

TEST_F(ImageOrderTest, RefusesTheVisibilityOfAnotherModel) {
  for (Eigen::Vector3f& point : sphere_.points) {
    point += Eigen::Vector3f(0, 0, 2);
  }
  ExpectFileError("another model", [&] { Find(file_order_); });
  ExpectFileError("another model",
                  [&] { Find(file_order_, ImageOrderKind::kFile); });
}

TEST_F(ImageOrderTest, AsksNothingWhereAllOrdersAreTheSame) {
  std::ranges::sort(sphere_.images, {}, &SphereWorkspace::Image::image_id);
  // The points were fused to other images, but all of them see the centre.
  sphere_.write_normals = false;
  sphere_.write_images = false;
  EXPECT_EQ(Find(file_order_).reason, OrderReason::kOnlyOne);
}

}  // namespace colmap_ext::image_order_test
