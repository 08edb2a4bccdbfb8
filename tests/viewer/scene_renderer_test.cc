#include "viewer/scene_renderer.h"

#include <cmath>
#include <memory>
#include <vector>

#include "pictures/drawings.h"
#include "pictures/mesh_renderer.h"
#include "pictures/picture_views.h"
#include "raster/facet_id_buffer.h"
#include "scene/look_at.h"
#include "tests/gl/gl_test.h"
#include "viewer/shown_mesh.h"

namespace colmap_ext::scene_renderer_test {

using SceneRendererTest = CurrentGlTest;

// A hilly sheet over the unit square, seen from above.
std::shared_ptr<ShownMesh> Hills(int size) {
  auto shown = std::make_shared<ShownMesh>();
  shown->name = "hills";
  TriangleMesh& mesh = shown->mesh;
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const float u = 1.0F * x / size;
      const float v = 1.0F * y / size;
      mesh.vertices.emplace_back(u, v,
                                 0.1F * std::sin(9 * u) * std::cos(7 * v));
    }
  }
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const uint32_t a = y * (size + 1) + x;
      const uint32_t b = a + size + 1;
      mesh.facets.push_back({a, a + 1, b + 1});
      mesh.facets.push_back({a, b + 1, b});
    }
  }
  return shown;
}

// With principal point and focal lengths that no symmetry hides.
View ViewFrom(const Eigen::Vector3d& eye) {
  View view = LookAtView(eye, {0.5, 0.5, 0}, {0, 1, 0}, 160, 120, 150);
  view.fy = 143;
  view.cx = 71.3;
  view.cy = 66.8;
  return view;
}

double MeanDifference(const ColorImage& a, const ColorImage& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      sum += std::abs(a.pixels[i][k] - b.pixels[i][k]);
    }
  }
  return sum / static_cast<double>(3 * a.pixels.size());
}

bool IsRed(const Color& color) {
  return color[0] > 2 * color[1] && color[0] > 2 * color[2];
}

// The exact camera: each pixel shows the facet that the rasterizer of the
// refinement finds there.
TEST_F(SceneRendererTest, ShowsTheFacetsThatTheViewSees) {
  const auto hills = Hills(20);
  const ShownScene scene{{hills}, nullptr, {}, {}, {}};
  SceneRenderer renderer;
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(0.4, 0.1, 1.2), Eigen::Vector3d(1.4, 1.1, 0.6)}) {
    const View view = ViewFrom(eye);
    const FacetIdBuffer drawn = DrawFacets(view, hills->mesh, 0);
    DrawSettings settings;
    settings.samples = 1;
    renderer.Draw(scene, view, settings);
    int num_other = 0;
    int num_drawn = 0;
    for (int row = 0; row < view.height; ++row) {
      for (int col = 0; col < view.width; ++col) {
        const uint32_t facet = drawn.facets[drawn.Index(row, col)];
        num_drawn += facet != kNone ? 1 : 0;
        num_other += renderer.FacetAt(row, col) != facet ? 1 : 0;
      }
    }
    EXPECT_GT(num_drawn, 3000);
    EXPECT_LT(num_other, 0.005 * num_drawn);  // on edges
  }
}

TEST_F(SceneRendererTest, AgreesWithTheRenderersOfReports) {
  const auto hills = Hills(8);
  hills->labels.resize(hills->mesh.facets.size());
  for (size_t i = 0; i < hills->labels.size(); ++i) {
    hills->labels[i] = static_cast<int32_t>(i % 7) - 1;
  }
  for (size_t i = 0; i < hills->mesh.vertices.size(); ++i) {
    hills->colors.push_back({static_cast<uint8_t>(i), 90, 200});
  }
  const View view = ViewFrom({0.4, 0.1, 1.2});
  const ShownScene scene{{hills}, nullptr, {}, {}, {}};
  SceneRenderer renderer;
  DrawSettings settings;
  settings.mode = MeshMode::kLabels;
  renderer.Draw(scene, view, settings);
  EXPECT_LT(
      MeanDifference(renderer.Read(),
                     RenderMesh(hills->mesh, view, LabelColors(hills->labels))),
      1);
  settings.mode = MeshMode::kColor;
  renderer.Draw(scene, view, settings);
  EXPECT_LT(
      MeanDifference(renderer.Read(),
                     RenderMesh(hills->mesh, view,
                                VertexColors(hills->mesh, hills->colors, 0))),
      1);
}

TEST_F(SceneRendererTest, BackFacesAreRedOnlyWhereMarked) {
  const ShownScene scene{{Hills(4)}, nullptr, {}, {}, {}};
  const View view = ViewFrom({0.5, 0.4, -1.2});
  SceneRenderer renderer;
  DrawSettings settings;
  renderer.Draw(scene, view, settings);
  EXPECT_FALSE(IsRed(renderer.Read().At(60, 80)));
  settings.backfaces = true;
  renderer.Draw(scene, view, settings);
  EXPECT_TRUE(IsRed(renderer.Read().At(60, 80)));
}

TEST_F(SceneRendererTest, ModesWithoutDataArePlainAndSaySo) {
  const auto hills = Hills(4);
  const ShownScene scene{{hills}, nullptr, {}, {}, {}};
  const View view = ViewFrom({0.4, 0.1, 1.2});
  SceneRenderer renderer;
  renderer.Draw(scene, view, {});
  const ColorImage shaded = renderer.Read();
  for (const MeshMode mode : {MeshMode::kColor, MeshMode::kLabels,
                              MeshMode::kErrors, MeshMode::kConfidence}) {
    DrawSettings settings;
    settings.mode = mode;
    renderer.Draw(scene, view, settings);
    EXPECT_EQ(renderer.Read().pixels, shaded.pixels) << NameOf(mode);
    EXPECT_NE(MissingData(*hills, mode), "");
  }
  EXPECT_EQ(MissingData(*hills, MeshMode::kNormals), "");
}

TEST_F(SceneRendererTest, ConfidencesAreColorsOfTheirScale) {
  const auto hills = Hills(4);
  hills->confidences.assign(hills->mesh.vertices.size(), 1);
  const ShownScene scene{{hills}, nullptr, {}, {}, {}};
  DrawSettings settings;
  settings.mode = MeshMode::kConfidence;
  SceneRenderer renderer;
  renderer.Draw(scene, ViewFrom({0.4, 0.1, 1.2}), settings);
  const Color seen = renderer.Read().At(60, 80);
  const Color yellow = ErrorColor(1, 1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(1.0 * seen[k] / yellow[k], 0.8, 0.2);
  }
}

TEST_F(SceneRendererTest, WireframeDarkensEdgesOnly) {
  const ShownScene scene{{Hills(4)}, nullptr, {}, {}, {}};
  const View view = ViewFrom({0.4, 0.1, 1.2});
  SceneRenderer renderer;
  renderer.Draw(scene, view, {});
  const ColorImage shaded = renderer.Read();
  DrawSettings settings;
  settings.wireframe = true;
  renderer.Draw(scene, view, settings);
  const ColorImage lines = renderer.Read();
  size_t num_changed = 0;
  for (size_t i = 0; i < lines.pixels.size(); ++i) {
    num_changed += lines.pixels[i] != shaded.pixels[i] ? 1 : 0;
  }
  EXPECT_GT(num_changed, 300);
  EXPECT_LT(num_changed, lines.pixels.size() / 4);
}

// The image of a camera lies exactly where the mesh is seen by it, also in a
// part of its view.
TEST_F(SceneRendererTest, TheImageFillsTheViewOfItsCamera) {
  const View camera = ViewFrom({0.4, 0.1, 1.2});
  ColorImage image{camera.width, camera.height, {}};
  for (int i = 0; i < image.width * image.height; ++i) {
    image.pixels.push_back({static_cast<uint8_t>(i % image.width),
                            static_cast<uint8_t>(i / image.width), 77});
  }
  ShownScene scene{{Hills(4)}, nullptr, {camera}, {}, {}};
  scene.images[0] = std::make_shared<const ColorImage>(image);
  DrawSettings settings;
  settings.image = 0;
  settings.image_opacity = 1;
  settings.samples = 1;
  SceneRenderer renderer;
  renderer.Draw(scene, camera, settings);
  EXPECT_LT(MeanDifference(renderer.Read(), image), 0.6);
  renderer.Draw(scene, CropView(camera, 2, 0.5, 0.5, 160, 120), settings);
  const Color middle = renderer.Read().At(60, 80);
  EXPECT_NEAR(middle[0], 80, 1);
  EXPECT_NEAR(middle[1], 60, 1);
}

TEST_F(SceneRendererTest, DrawsTheNearerOfTwoPoints) {
  auto cloud = std::make_shared<PointCloud>();
  cloud->positions = {{0.5F, 0.5F, 0}, {0.5F, 0.5F, 0.5F}};
  cloud->colors = {{10, 20, 30}, {200, 100, 0}};
  const ShownScene scene{{}, cloud, {}, {}, {}};
  DrawSettings settings;
  settings.points = true;
  settings.point_radius = 4;
  SceneRenderer renderer;
  const View above =
      LookAtView({0.5, 0.5, 2}, {0.5, 0.5, 0}, {0, 1, 0}, 64, 48, 80);
  renderer.Draw(scene, above, settings);
  EXPECT_EQ(renderer.Read().At(24, 32), (Color{200, 100, 0}));
  const View below =
      LookAtView({0.5, 0.5, -2}, {0.5, 0.5, 0}, {0, 1, 0}, 64, 48, 80);
  renderer.Draw(scene, below, settings);
  EXPECT_EQ(renderer.Read().At(24, 32), (Color{10, 20, 30}));
}

}  // namespace colmap_ext::scene_renderer_test
