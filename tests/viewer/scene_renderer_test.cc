#include "viewer/scene_renderer.h"

#include <cmath>

#include "pictures/pictures.h"
#include "raster/facet_id_buffer.h"
#include "tests/gl/gl_test.h"
#include "tests/mesh/known_meshes.h"
#include "tests/pictures/compare_pictures.h"
#include "tests/raster/pixels.h"

namespace colmap_ext::scene_renderer_test {

struct SceneRendererTest : CurrentGlTest {
  void SetUp() override {
    CurrentGlTest::SetUp();
    if (context_) {
      renderer_.emplace();
    }
  }
  void TearDown() override {
    renderer_.reset();
    CurrentGlTest::TearDown();
  }

  ColorImage Draw(const ShownScene& scene, const View& view) {
    renderer_->Draw(scene, view, settings_);
    return renderer_->Read();
  }

  DrawSettings settings_;
  std::optional<SceneRenderer> renderer_;
};

// A hilly sheet over the unit square, seen from above.
std::shared_ptr<ShownMesh> Hills(int size) {
  auto shown = std::make_shared<ShownMesh>();
  shown->name = "hills";
  shown->mesh = MakeSheet(size, size);
  for (Eigen::Vector3f& vertex : shown->mesh.vertices) {
    vertex /= static_cast<float>(size);
    vertex.z() = 0.1F * std::sin(9 * vertex.x()) * std::cos(7 * vertex.y());
  }
  return shown;
}

ShownScene SceneOf(const std::shared_ptr<ShownMesh>& mesh) {
  return {{mesh}, nullptr, {}, {}, {}};
}

// With principal point and focal lengths that no symmetry hides.
View ViewFrom(const Eigen::Vector3d& eye = {0.4, 0.1, 1.2}) {
  View view = LookAtView(eye, {0.5, 0.5, 0}, {0, 1, 0}, 160, 120, 150);
  view.fy = 143;
  view.cx = 71.3;
  view.cy = 66.8;
  return view;
}

// The exact camera: each pixel shows the facet that the rasterizer of the
// refinement finds there.
TEST_F(SceneRendererTest, ShowsTheFacetsThatTheViewSees) {
  const auto hills = Hills(20);
  settings_.samples = 1;
  for (const View& view : {ViewFrom(), ViewFrom({1.4, 1.1, 0.6})}) {
    const DrawnFacets drawn = DrawFacets(view, hills->mesh, 0);
    Draw(SceneOf(hills), view);
    int num_other = 0;
    int num_drawn = 0;
    ForEachPixel(view, [&](int row, int col) {
      const uint32_t facet = drawn.facets[drawn.Index(row, col)];
      num_drawn += facet != kNone ? 1 : 0;
      num_other += renderer_->FacetAt(row, col) != facet ? 1 : 0;
    });
    EXPECT_GT(num_drawn, 3000);
    EXPECT_LT(num_other, 0.005 * num_drawn);  // on edges
  }
}

TEST_F(SceneRendererTest, AgreesWithTheRenderersOfReports) {
  const auto hills = Hills(8);
  for (size_t i = 0; i < hills->mesh.facets.size(); ++i) {
    hills->labels.push_back(static_cast<int32_t>(i % 7) - 1);
  }
  for (size_t i = 0; i < hills->mesh.vertices.size(); ++i) {
    hills->colors.push_back({static_cast<uint8_t>(i), 90, 200});
  }
  const auto expect_agreement = [&](MeshMode mode, const auto& colors) {
    settings_.mode = mode;
    EXPECT_LT(MeanDifference(Draw(SceneOf(hills), ViewFrom()),
                             RenderMesh(hills->mesh, ViewFrom(), colors)),
              1);
  };
  expect_agreement(MeshMode::kLabels, LabelColors(hills->labels));
  expect_agreement(MeshMode::kColor,
                   VertexColors(hills->mesh, hills->colors, 0));
}

TEST_F(SceneRendererTest, BackFacesAreRedOnlyWhereMarked) {
  for (const bool is_marked : {false, true}) {
    settings_.backfaces = is_marked;
    const ColorImage picture =
        Draw(SceneOf(Hills(4)), ViewFrom({0.5, 0.4, -1.2}));
    EXPECT_EQ(IsRed(picture.At(60, 80)), is_marked);
  }
}

TEST_F(SceneRendererTest, ModesWithoutDataArePlainAndSaySo) {
  const auto hills = Hills(4);
  const ColorImage shaded = Draw(SceneOf(hills), ViewFrom());
  for (const MeshMode mode : {MeshMode::kColor, MeshMode::kLabels,
                              MeshMode::kErrors, MeshMode::kConfidence}) {
    settings_.mode = mode;
    EXPECT_EQ(Draw(SceneOf(hills), ViewFrom()).pixels, shaded.pixels)
        << NameOf(mode);
    EXPECT_NE(MissingData(*hills, mode), "");
  }
  EXPECT_EQ(MissingData(*hills, MeshMode::kNormals), "");
}

TEST_F(SceneRendererTest, ConfidencesAreColorsOfTheirScale) {
  const auto hills = Hills(4);
  hills->confidences.assign(hills->mesh.vertices.size(), 1);
  settings_.mode = MeshMode::kConfidence;
  const Color seen = Draw(SceneOf(hills), ViewFrom()).At(60, 80);
  const Color yellow = ErrorColor(1, 1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(1.0 * seen[k] / yellow[k], 0.8, 0.2);
  }
}

TEST_F(SceneRendererTest, WireframeDarkensEdgesOnly) {
  const auto hills = Hills(4);
  const ColorImage shaded = Draw(SceneOf(hills), ViewFrom());
  settings_.wireframe = true;
  const ColorImage lines = Draw(SceneOf(hills), ViewFrom());
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
  const View camera = ViewFrom();
  ColorImage image{camera.width, camera.height, {}};
  for (int i = 0; i < image.width * image.height; ++i) {
    image.pixels.push_back({static_cast<uint8_t>(i % image.width),
                            static_cast<uint8_t>(i / image.width), 77});
  }
  ShownScene scene = SceneOf(Hills(4));
  scene.views = {camera};
  scene.images[0] = std::make_shared<const ColorImage>(image);
  settings_.image = 0;
  settings_.image_opacity = 1;
  settings_.samples = 1;
  EXPECT_LT(MeanDifference(Draw(scene, camera), image), 0.6);
  const Color middle =
      Draw(scene, CropView(camera, 2, 0.5, 0.5, 160, 120)).At(60, 80);
  EXPECT_NEAR(middle[0], 80, 1);
  EXPECT_NEAR(middle[1], 60, 1);
}

TEST_F(SceneRendererTest, DrawsTheNearerOfTwoPoints) {
  auto cloud = std::make_shared<PointCloud>();
  cloud->positions = {{0.5F, 0.5F, 0}, {0.5F, 0.5F, 0.5F}};
  cloud->colors = {{10, 20, 30}, {200, 100, 0}};
  const ShownScene scene{{}, cloud, {}, {}, {}};
  settings_.points = true;
  settings_.point_radius = 4;
  const auto color_from = [&](double height) {
    return Draw(scene, LookAtView({0.5, 0.5, height}, {0.5, 0.5, 0}, {0, 1, 0},
                                  64, 48, 80))
        .At(24, 32);
  };
  EXPECT_EQ(color_from(2), (Color{200, 100, 0}));
  EXPECT_EQ(color_from(-2), (Color{10, 20, 30}));
}

}  // namespace colmap_ext::scene_renderer_test
