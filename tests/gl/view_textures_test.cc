#include "gl/pair_passes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gl/egl_context.h"
#include "raster/facet_id_buffer.h"
#include "tests/gl/gl_test.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {
namespace view_textures_test {

struct Drawn {
  std::vector<uint32_t> facets;
  std::vector<float> inverse_depths;
};

Drawn Draw(const View& view, const TriangleMesh& mesh) {
  GlBuffer vertices, facets;
  vertices.Assign(mesh.vertices);
  facets.Assign(mesh.facets);
  FacetDrawer drawer(0.1);
  FacetTextures textures(view.width, view.height);
  drawer.Draw(view, mesh, vertices, facets, &textures);
  Drawn drawn = {
      textures.facets.Read<uint32_t>(GL_RED_INTEGER, GL_UNSIGNED_INT),
      textures.depths.Read<float>(GL_DEPTH_COMPONENT, GL_FLOAT)};
  for (float& depth : drawn.inverse_depths) {
    depth /= textures.depth_scale;
  }
  ThrowOnGlError("drawing");
  return drawn;
}

// Signed distance of a pixel's centre from the nearest edge of a facet, px;
// positive inside.
double Inside(const View& view, const TriangleMesh& mesh, uint32_t facet,
              size_t pixel) {
  const Eigen::Vector2d center(pixel % view.width + 0.5,
                               pixel / view.width + 0.5);
  std::array<Eigen::Vector2d, 3> corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = view.ImageFromCam(
        view.CamFromWorld(mesh.vertices[mesh.facets[facet][k]].cast<double>()));
  }
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  const double sign =
      cross(corners[1] - corners[0], corners[2] - corners[0]) < 0 ? -1 : 1;
  double distance = 1e9;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector2d edge = corners[(k + 1) % 3] - corners[k];
    distance = std::min(distance,
                        sign * cross(edge, center - corners[k]) / edge.norm());
  }
  return distance;
}

class FacetDrawerTest : public CurrentGlTest {};

TEST_F(FacetDrawerTest, DrawsWhatTheProcessorDraws) {
  size_t num_pixels = 0;
  size_t num_different = 0;
  for (const char* shape : {"statue", "grid"}) {
    const RefinementScene scene = MakeRefinementScene(shape, 3, 200);
    const TriangleMesh mesh = scene.Perturbed(0.3);
    for (const View& view : scene.Views()) {
      const Drawn drawn = Draw(view, mesh);
      const FacetIdBuffer reference = DrawFacets(view, mesh, 0.1);
      num_pixels += drawn.facets.size();
      for (size_t i = 0; i < drawn.facets.size(); ++i) {
        if (drawn.facets[i] != reference.facets[i]) {
          ++num_different;
          for (const uint32_t facet : {drawn.facets[i], reference.facets[i]}) {
            EXPECT_TRUE(facet == kNone ||
                        std::abs(Inside(view, mesh, facet, i)) < 1.0 / 128)
                << "pixel " << i << " facet " << facet;
          }
        } else if (drawn.facets[i] != kNone) {
          EXPECT_NEAR(drawn.inverse_depths[i] / reference.inverse_depths[i], 1,
                      1e-4);
        }
      }
    }
  }
  EXPECT_LT(num_different, 1e-4 * num_pixels);
  RecordProperty("pixels_that_differ", static_cast<int>(num_different));
}

// A triangle that covers the image of 8 x 6.
TriangleMesh Triangle(float z) {
  return {{{-9, -9, z}, {30, -9, z}, {-9, 30, z}}, {{0, 1, 2}}};
}

View SmallView() {
  View view;
  view.width = 8;
  view.height = 6;
  view.fx = view.fy = 8;
  view.cx = 4;
  view.cy = 3;
  return view;
}

TEST_F(FacetDrawerTest, RowsAreFromTheTop) {
  // Its upper left half.
  TriangleMesh mesh = {{{-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}}, {{0, 1, 2}}};
  const Drawn drawn = Draw(SmallView(), mesh);
  EXPECT_EQ(drawn.facets.front(), 0);
  EXPECT_EQ(drawn.facets.back(), kNone);
  EXPECT_EQ(drawn.inverse_depths.front(), 1);
  EXPECT_EQ(drawn.inverse_depths.back(), 0);
}

TEST_F(FacetDrawerTest, NearestOfEqualOnesFirstWins) {
  TriangleMesh mesh = Triangle(3);
  for (const float z : {2.0F, 2.0F, 4.0F}) {
    const TriangleMesh other = Triangle(z);
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(),
                         other.vertices.end());
    mesh.facets.push_back({first, first + 2, first + 1});
  }
  const Drawn drawn = Draw(SmallView(), mesh);
  EXPECT_EQ(drawn.facets, std::vector<uint32_t>(48, 1));
}

TEST_F(FacetDrawerTest, FacetsThatReachBehindTheCameraAreDrawnByAPart) {
  for (const float z : {-1.0F, 0.0F, 1e-9F}) {
    TriangleMesh mesh = Triangle(2);
    mesh.vertices[2].z() = z;
    mesh.vertices.emplace_back(0.0F, 0.0F, 5.0F);
    const Drawn drawn = Draw(SmallView(), mesh);
    EXPECT_EQ(drawn.facets, std::vector<uint32_t>(48, 0)) << z;
    EXPECT_EQ(DrawFacets(SmallView(), mesh, 0.1).facets, drawn.facets) << z;
  }
}

TEST_F(FacetDrawerTest, DrawsARoomFromInsideAsTheProcessorDoes) {
  const RefinementScene scene = MakeRoomScene(6);
  const TriangleMesh& room = scene.Truth();
  for (const View& view : scene.Views()) {
    const Drawn drawn = Draw(view, room);
    const FacetIdBuffer reference = DrawFacets(view, room, 0.1);
    size_t num_different = 0;
    for (size_t i = 0; i < drawn.facets.size(); ++i) {
      ASSERT_NE(reference.facets[i], kNone);
      // On an edge either facet will do, but no pixel falls between them.
      num_different += drawn.facets[i] != reference.facets[i] ? 1 : 0;
      EXPECT_NEAR(drawn.inverse_depths[i] / reference.inverse_depths[i], 1,
                  1e-4)
          << "pixel " << i;
    }
    EXPECT_LT(num_different, 1e-4 * drawn.facets.size());
  }
}

TEST_F(FacetDrawerTest, EmptyMeshIsNothing) {
  EXPECT_EQ(Draw(SmallView(), {}).facets, std::vector<uint32_t>(48, kNone));
}

}  // namespace view_textures_test
}  // namespace colmap_ext
