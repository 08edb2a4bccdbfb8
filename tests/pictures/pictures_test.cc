#include "pictures/pictures.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/pictures/compare_pictures.h"
#include "tests/random.h"

namespace colmap_ext::pictures_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

View ViewFrom(double z) {
  return LookAtView({0, 0, z}, {0, 0, 0}, {0, 1, 0}, 64, 48, 96);
}

TEST(ErrorColor, GoesFromOneEndOfTheScaleToTheOther) {
  EXPECT_EQ(ErrorColor(0, 2), (Color{68, 1, 84}));
  EXPECT_EQ(ErrorColor(2, 2), (Color{253, 231, 37}));
  EXPECT_EQ(ErrorColor(7, 2), ErrorColor(2, 2));
  for (int i = 0; i < 100; ++i) {  // green only grows
    EXPECT_LE(ErrorColor(i, 100)[1], ErrorColor(i + 1, 100)[1]);
  }
}

TEST(ErrorScale, IsRoundAndAboveMostErrors) {
  EXPECT_DOUBLE_EQ(ErrorScale({0.0013}), 0.002);
  EXPECT_DOUBLE_EQ(ErrorScale({30}), 50);
  EXPECT_DOUBLE_EQ(ErrorScale({7}), 10);
  EXPECT_EQ(ErrorScale({0, 0}), 1);
  EXPECT_EQ(ErrorScale({}), 1);
  std::vector<double> errors(99, 1.5);
  errors.push_back(1000);
  EXPECT_EQ(ErrorScale(errors), 2);
}

constexpr Color kWhite = {255, 255, 255};

size_t NumDrawn(const ColorImage& image) {
  return image.pixels.size() - std::ranges::count(image.pixels, kWhite);
}

TEST(DrawPoints, HasTheNearerPointOnTopAndCutsOthersAtTheBorder) {
  const PointCloud cloud = {
      {{0, 0, 0}, {0, 0, -1}}, {{10, 20, 30}, {200, 0, 0}}, {}};
  const ColorImage front = DrawPoints(cloud, ViewFrom(3), 2);
  const ColorImage back = DrawPoints(cloud, ViewFrom(-3), 2);
  EXPECT_EQ(NumDrawn(front), 4);
  EXPECT_EQ(front.At(24, 32), (Color{10, 20, 30}));
  EXPECT_EQ(back.At(24, 32), (Color{200, 0, 0}));
  const PointCloud others = {{{1, 0, 0}, {0, 0, 9}, {1e30f, 0, 0}}, {}, {}};
  EXPECT_EQ(NumDrawn(DrawPoints(others, ViewFrom(3), 4)), 8)
      << "half of the square of the first";
  EXPECT_EQ(NumDrawn(DrawPoints({}, ViewFrom(3), 4)), 0);
}

TEST(ResizePicture, TakesMeans) {
  constexpr Color kGray = {8, 8, 8};
  const std::vector<Color> pixels = {{0, 0, 0},   {100, 0, 0}, kGray, kGray,  //
                                     {100, 0, 0}, {200, 0, 0}, kGray, kGray};
  const ColorImage image{4, 2, pixels};
  const ColorImage half = ResizePicture(image, 2, 1);
  EXPECT_EQ(half.width, 2);
  EXPECT_EQ(half.height, 1);
  EXPECT_EQ(half.pixels, (std::vector<Color>{{100, 0, 0}, kGray}));
  EXPECT_EQ(ResizePicture(image, 4, 2).pixels, image.pixels);
  EXPECT_EQ(ResizePicture(image, 40, 20).At(19, 39), kGray);
}

// A square in the plane z = 0 whose front is seen from z > 0.
TriangleMesh Square() {
  return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
          {{0, 1, 2}, {0, 2, 3}}};
}

Color Middle(const ColorImage& image) { return image.At(24, 32); }

TEST(RenderMesh, BackFacesAreRedAndNotShadedByTheCaller) {
  const auto black = [](const FrontHit&) { return Vector3f(0, 0, 0); };
  EXPECT_EQ(Middle(RenderMesh(Square(), ViewFrom(3), black)), (Color{0, 0, 0}));
  EXPECT_TRUE(IsRed(Middle(RenderMesh(Square(), ViewFrom(-3), black))));
}

TEST(RenderMesh, TellsWhereTheRayHits) {
  const TriangleMesh mesh = Square();
  RenderMesh(mesh, ViewFrom(3), [&](const FrontHit& hit) -> Vector3f {
    EXPECT_NEAR(hit.areas.sum(), 4, 1e-5);
    EXPECT_GT(hit.areas.minCoeff(), -1e-4);
    EXPECT_GE(hit.light, 0);
    EXPECT_LE(hit.light, 1);
    return {0, 0, 0};
  });
}

TEST(LabelColors, AreShaded) {
  for (const int32_t label : {-1, 0, 1, 7}) {
    const std::vector<int32_t> labels = {label, label};
    const Color color = LabelColor(label);
    const Color seen =
        Middle(RenderMesh(Square(), ViewFrom(3), LabelColors(labels)));
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(seen[i], color[i]);
      EXPECT_NEAR(1.0 * seen[i] / color[i], 1.0 * seen[0] / color[0], 0.02);
    }
    EXPECT_TRUE(
        IsRed(Middle(RenderMesh(Square(), ViewFrom(-3), LabelColors(labels)))));
  }
}

TEST(MeshRenderer, DrawsSeveralColorsAsItDrawsEachAlone) {
  const TriangleMesh mesh = Square();
  const std::vector<Color> colors = {
      {10, 20, 30}, {200, 0, 90}, {0, 0, 0}, {255, 255, 255}};
  const std::vector<int32_t> labels = {3, 4};
  const View view = ViewFrom(3);
  const std::vector<ColorImage> images = MeshRenderer(mesh).Draw(
      view, {PlainColor(), LabelColors(labels), VertexColors(mesh, colors, 0)});
  ASSERT_EQ(images.size(), 3);
  EXPECT_EQ(images[0].pixels, RenderMesh(mesh, view, PlainColor()).pixels);
  EXPECT_EQ(images[1].pixels,
            RenderMesh(mesh, view, LabelColors(labels)).pixels);
  EXPECT_EQ(images[2].pixels,
            RenderMesh(mesh, view, VertexColors(mesh, colors, 0)).pixels);
}

TEST(VertexColors, ShadesAsMuchAsIsAskedFor) {
  const TriangleMesh mesh = Square();
  const std::vector<Color> white(4, {255, 255, 255});
  const auto brightness = [&](float shade) {
    return Middle(
        RenderMesh(mesh, ViewFrom(3), VertexColors(mesh, white, shade)))[0];
  };
  EXPECT_EQ(brightness(0), 255);
  EXPECT_LT(brightness(1), brightness(0.5f));
  EXPECT_NEAR(brightness(0.5f), (255 + brightness(1)) / 2.0, 1);
}

TEST(CropView, ScalesThePartThatIsAskedFor) {
  const View view = LookAtView({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 640, 480, 960);
  const View crop = CropView(view, 4, 0.25, 0.75, 320, 240);
  const Vector3d point =
      view.cam_from_world_rotation.transpose() *
      (Vector3d((160 - view.cx) / view.fx, (360 - view.cy) / view.fy, 1) -
       view.cam_from_world_translation);
  const Eigen::Vector2d middle = crop.ImageFromCam(crop.CamFromWorld(point));
  EXPECT_NEAR(middle.x(), 160, 1e-9);
  EXPECT_NEAR(middle.y(), 120, 1e-9);
  EXPECT_NEAR(crop.fx, 2 * view.fx, 1e-9);
}

TEST(AutomaticView, HasTheMeshInItsPicture) {
  Random random(1);
  TriangleMesh mesh;
  for (int i = 0; i < 500; ++i) {
    mesh.vertices.emplace_back(7 + 3 * random.Unit(), 2 * random.Unit(),
                               random.Unit());
  }
  mesh.vertices.emplace_back(1e4f, 0, 0);  // a stray one
  const View view = AutomaticView(mesh, 400, 300);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = view.CamFromWorld(mesh.vertices[i].cast<double>());
    ASSERT_GT(p.z(), 0);
    const Eigen::Vector2d pixel = view.ImageFromCam(p);
    EXPECT_GT(pixel.minCoeff(), -15);
    EXPECT_LT(pixel.x(), 415);
    EXPECT_LT(pixel.y(), 315);
  }
}

// Views at these places along a line.
std::vector<View> ViewsAt(const std::vector<double>& places) {
  std::vector<View> views;
  for (const double x : places) {
    views.push_back(LookAtView({x, 0, 5}, {x, 0, 0}, {0, 1, 0}, 640, 480, 960));
  }
  return views;
}

TEST(SpreadViews, AreFarApartOfThoseThatSeeMuchOrFew) {
  const std::vector<View> views = ViewsAt({0, 1, 2, 3, 4, 50});
  const std::vector<size_t> num_seen = {5, 5, 9, 5, 6, 4};
  EXPECT_EQ(SpreadViews(views, num_seen, 1), (std::vector<size_t>{2}));
  EXPECT_EQ(SpreadViews(views, num_seen, 3), (std::vector<size_t>{2, 0, 4}));
  EXPECT_EQ(SpreadViews(views, num_seen, 9).size(), 5);
  EXPECT_TRUE(SpreadViews({}, {}, 3).empty());
  EXPECT_TRUE(SpreadViews(ViewsAt({0, 1}), {0, 0}, 3).empty());
  EXPECT_EQ(SpreadViews(ViewsAt({0, 1}), {0, 7}, 3), (std::vector<size_t>{1}));
  EXPECT_EQ(SpreadViews(ViewsAt({1, 1, 1}), {7, 7, 7}, 3),
            (std::vector<size_t>{0}))
      << "all at one place";
}

}  // namespace colmap_ext::pictures_test
