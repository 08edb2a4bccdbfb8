#include "colmap_ext/report/page_pictures.h"

#include <gtest/gtest.h>

#include "scene/view.h"

namespace colmap_ext {
namespace page_pictures_test {

constexpr Color kWhite = {255, 255, 255};

// A square in the plane z = 0 that four cameras at z = 3 see, and one that
// looks away.
struct Square {
  Square() {
    for (const double x : {0.0, 0.1, -1.0, 1.0}) {
      views.push_back(
          LookAtView({x, 0, 3}, {0, 0, 0}, {0, 1, 0}, 600, 300, 500));
    }
    views.push_back(LookAtView({9, 0, 3}, {9, 0, 9}, {0, 1, 0}, 600, 300, 500));
    for (size_t i = 0; i < views.size(); ++i) {
      views[i].name = std::to_string(i);
    }
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      vertex_views.AddRow(std::vector<uint32_t>{0, 1, 2, 3});
    }
  }

  TriangleMesh mesh = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                       {{0, 1, 2}, {0, 2, 3}}};
  std::vector<View> views;
  Rows<uint32_t> vertex_views;
};

// No picture of the third camera can be read.
PictureDecoder Decoder() {
  PictureDecoder decoder;
  decoder.read_color =
      [](const std::filesystem::path& path) -> std::optional<ColorImage> {
    EXPECT_EQ(path.parent_path(), "images");
    if (path.filename() == "2") {
      return std::nullopt;
    }
    return ColorImage{6, 3, std::vector<Color>(18, {10, 20, 30})};
  };
  return decoder;
}

PageCameras Cameras(const Square& square) {
  return ChoosePageCameras(square.views, square.vertex_views, "images",
                           Decoder());
}

TEST(ChoosePageCamerasTest, TakesThreeThatSeeTheMeshAndAreFarApart) {
  const PageCameras cameras = Cameras(Square());
  ASSERT_EQ(cameras.views.size(), 3);
  EXPECT_EQ(cameras.views[0].name, "0");
  EXPECT_EQ(cameras.views[1].name, "2");
  EXPECT_EQ(cameras.views[2].name, "3");
  EXPECT_EQ(cameras.views[0].width, 480);
  EXPECT_EQ(cameras.views[0].height, 240);
  ASSERT_EQ(cameras.photos.size(), 3);
  EXPECT_EQ(cameras.photos[0].width, 480);
  EXPECT_EQ(cameras.photos[0].At(239, 479), (Color{10, 20, 30}));
  EXPECT_EQ(cameras.photos[1].width, 0);
}

TEST(ChoosePageCamerasTest, TakesNoneWhereNothingIsSeen) {
  Square square;
  square.vertex_views = Rows<uint32_t>(square.mesh.vertices.size());
  EXPECT_TRUE(Cameras(square).views.empty());
}

void ExpectAllDrawn(const PagePictures& page, size_t num_rows) {
  ASSERT_EQ(page.cameras.size(), 3);
  ASSERT_EQ(page.rows.size(), num_rows);
  for (size_t i = 1; i < num_rows; ++i) {
    ASSERT_EQ(page.rows[i].pictures.size(), 3) << page.rows[i].title;
    for (const ColorImage& picture : page.rows[i].pictures) {
      EXPECT_EQ(picture.width, 480);
      EXPECT_NE(picture.At(120, 240), kWhite) << page.rows[i].title;
      EXPECT_EQ(picture.At(0, 0), kWhite) << page.rows[i].title;
    }
  }
}

TEST(DrawRefinementTest, DrawsBeforeAfterLabelsAndConfidence) {
  const Square square;
  RefinedMesh refined;
  refined.mesh = square.mesh;
  refined.attributes.confidences.assign(4, 1);
  refined.labels.pairs = {{0, 1}};
  refined.labels.labels.AddRow(std::vector<uint32_t>{0});
  refined.labels.labels.EndRow();
  TriangleMesh before = square.mesh;
  std::swap(before.facets[0][0], before.facets[0][1]);
  std::swap(before.facets[1][0], before.facets[1][1]);
  const PagePictures page = DrawRefinement(Cameras(square), before, refined);
  ExpectAllDrawn(page, 5);
  const Color back = page.rows[1].pictures[0].At(120, 240);
  EXPECT_GT(back[0], 2 * back[1]) << "seen from behind";
  const ColorImage& labels = page.rows[3].pictures[0];
  EXPECT_NE(labels.At(150, 270), labels.At(90, 210)) << "a label and none";
  const Color confidence = page.rows[4].pictures[0].At(120, 240);
  EXPECT_GT(confidence[0], 2 * confidence[2]) << "yellow";
}

TEST(DrawMeshingTest, DrawsPointsMeshConfidenceAndColors) {
  const Square square;
  ManifoldMesh mesh;
  mesh.mesh = square.mesh;
  mesh.attributes.colors.assign(4, {200, 100, 50});
  const PointCloud cloud = {{{0, 0, 0}}, {{1, 2, 3}}, {}};
  PagePictures page = DrawMeshing(Cameras(square), cloud, mesh);
  ExpectAllDrawn(page, 5);
  EXPECT_EQ(page.rows[1].pictures[0].At(120, 240), (Color{1, 2, 3}));
  EXPECT_EQ(page.rows[4].pictures[0].At(120, 240), (Color{200, 100, 50}));
  mesh.attributes.colors.clear();
  page = DrawMeshing(Cameras(square), cloud, mesh);
  EXPECT_EQ(page.rows[4].pictures[0].pixels, page.rows[2].pictures[0].pixels);
}

}  // namespace page_pictures_test
}  // namespace colmap_ext
