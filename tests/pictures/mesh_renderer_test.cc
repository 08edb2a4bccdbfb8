#include "pictures/mesh_renderer.h"

#include <gtest/gtest.h>

#include "scene/look_at.h"

namespace colmap_ext {
namespace mesh_renderer_test {

// A square in the plane z = 0 whose front is seen from z > 0.
TriangleMesh Square() {
  return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
          {{0, 1, 2}, {0, 2, 3}}};
}

View ViewFrom(double z) {
  return LookAtView({0.1, 0, z}, {0.1, 0, 0}, {0, 1, 0}, 64, 48, 96);
}

Color Middle(const ColorImage& image) { return image.At(24, 32); }

bool IsRed(const Color& color) {
  return color[0] > 2 * color[1] && color[0] > 2 * color[2];
}

TEST(RenderMesh, BackFacesAreRedAndNotShadedByTheCaller) {
  const auto black = [](const FrontHit&) { return Eigen::Vector3f(0, 0, 0); };
  EXPECT_EQ(Middle(RenderMesh(Square(), ViewFrom(3), black)), (Color{0, 0, 0}));
  EXPECT_TRUE(IsRed(Middle(RenderMesh(Square(), ViewFrom(-3), black))));
}

TEST(RenderMesh, TellsWhereTheRayHits) {
  const TriangleMesh mesh = Square();
  RenderMesh(mesh, ViewFrom(3), [&](const FrontHit& hit) -> Eigen::Vector3f {
    EXPECT_NEAR(hit.depth, 3, 1e-5);
    EXPECT_NEAR((hit.normal - Eigen::Vector3f::UnitZ()).norm(), 0, 1e-6);
    EXPECT_NEAR(hit.areas.sum(), 4, 1e-5);
    EXPECT_GT(hit.areas.minCoeff(), -1e-4);
    EXPECT_GE(hit.light, 0);
    EXPECT_LE(hit.light, 1);
    return {0, 0, 0};
  });
}

TEST(VertexColors, InterpolateWithoutShades) {
  const TriangleMesh mesh = Square();
  const std::vector<Color> colors(4, {10, 20, 30});
  const FrontColor front = VertexColors(mesh, colors, 0);
  EXPECT_EQ(Middle(RenderMesh(mesh, ViewFrom(3), front)), (Color{10, 20, 30}));
  EXPECT_TRUE(IsRed(Middle(RenderMesh(mesh, ViewFrom(-3), front))));
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

}  // namespace mesh_renderer_test
}  // namespace colmap_ext
