#include "photometry/pair_warp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/visible_facets.h"

namespace colmap_ext::pair_warp_test {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Smooth waves.
GrayImage Paint(const View& view, const TriangleMesh& mesh) {
  return PaintedImage(view, mesh, [](const Vector3d& point) {
    const double wave = std::sin(9 * point.x() + 2 * point.z()) +
                        std::cos(8 * point.y() - 3 * point.z());
    return std::round(127 + 60 * wave);
  });
}

// Two views of a mesh with all that a warp takes.
struct WarpScene {
  WarpScene(TriangleMesh surface, const View& view_i, const View& view_j)
      : mesh(std::move(surface)),
        views{view_i, view_j},
        images{Paint(view_i, mesh), Paint(view_j, mesh)},
        drawn{DrawFacets(view_i, mesh, 0.1), DrawFacets(view_j, mesh, 0.1)} {}

  PairWarp Warp(int i, int j) const {
    return {{views[i], images[i], drawn[i], mesh},
            {views[j], images[j], drawn[j], mesh},
            mesh};
  }

  FacetFrame Frame(uint32_t facet) const {
    return ComputeFacetFrame(mesh, mesh.facets[facet]);
  }

  // The point on a facet's plane that pixel (row, col) of view i shows.
  Vector3d PointAt(int i, uint32_t facet, int row, int col) const {
    const FacetFrame frame = Frame(facet);
    const Vector3d eye = views[i].Center();
    const Vector3d ray =
        views[i].RayFromPixel() * Vector3d(col + 0.5, row + 0.5, 1);
    return eye +
           frame.normal.dot(frame.corner - eye) / frame.normal.dot(ray) * ray;
  }

  TriangleMesh mesh;
  View views[2];
  GrayImage images[2];
  DrawnFacets drawn[2];
};

struct Warped {
  CorrelationTile tile;
  TileGeometry geometry;
};

Warped Compute(const PairWarp& warp, int first_row, int first_col, int height,
               int width) {
  Warped warped;
  warped.tile.Resize(width, height);
  std::ranges::fill(warped.tile.is_reached, 1);
  warped.geometry.first_row = first_row;
  warped.geometry.first_col = first_col;
  warp.Compute(&warped.tile, &warped.geometry);
  return warped;
}

// That a pixel has the values of a pixel of another warp, but for its image
// and depth; or that it is not valid, where is_known is false.
void ExpectPixel(const Warped& warped, size_t at, const Warped& expected,
                 size_t from, bool is_known) {
  EXPECT_EQ(warped.tile.is_valid[at],
            is_known ? expected.tile.is_valid[from] : 0);
  EXPECT_EQ(warped.tile.warped[at], is_known ? expected.tile.warped[from] : 0);
  EXPECT_EQ(warped.geometry.motion[at],
            is_known ? expected.geometry.motion[from] : 0);
  EXPECT_EQ(warped.geometry.facets[at],
            is_known ? expected.geometry.facets[from] : kNone);
}

// Of the whole image.
Warped Compute(const WarpScene& scene, int i, int j) {
  return Compute(scene.Warp(i, j), 0, 0, scene.views[i].height,
                 scene.views[i].width);
}

// A rough sheet of sides of 2, and a lid of 0.4 over its middle that hides a
// part of it, not the same one from both views.
WarpScene MakeScene() {
  Random random(1);
  const auto sheet = [](const Vector3f& p) -> Vector3f {
    const Vector3f at = 2 * p - Vector3f(1, 1, 0);
    return {at.x(), at.y(), 0.1f * std::sin(3 * at.x()) * std::cos(2 * at.y())};
  };
  const auto lid = [](const Vector3f& p) -> Vector3f {
    return 0.2f * (p - Vector3f(1, 1, 0)) + Vector3f(0, 0, 0.6f);
  };
  return {Union(Moved(MakeJitteredSquare(12, &random), sheet),
                Moved(MakeSheet(2, 2), lid)),
          LookAt({-0.6, 0.1, 3}, {0, 0, 0}, 130, 110, 190),
          LookAt({0.7, -0.2, 3.2}, {0.1, 0, 0}, 120, 100, 170)};
}

Vector2d SeenAt(const View& view, const Vector3d& point) {
  return view.ImageFromCam(view.CamFromWorld(point));
}

TEST(PairWarp, FindsWhereOnTheirFacetsPixelsLie) {
  const WarpScene scene = MakeScene();
  const Warped warped = Compute(scene, 0, 1);
  size_t num_compared = 0;
  ForEachPixel(warped.tile, [&](int row, int col) {
    const size_t at = warped.tile.Index(row, col);
    const uint32_t facet = warped.geometry.facets[at];
    if (facet == kNone) {
      return;
    }
    ++num_compared;
    const Vector3d expected =
        Barycentric(scene.Frame(facet), scene.PointAt(0, facet, row, col));
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(warped.geometry.barycentric[at][k], expected[k], 1e-6);
      EXPECT_GT(warped.geometry.barycentric[at][k], -0.02);
    }
  });
  EXPECT_GT(num_compared, 0.4 * warped.tile.image.size());
}

TEST(PairWarp, OfTheTrueSurfaceShowsTheSame) {
  const WarpScene scene = MakeScene();
  const Bvh bvh(scene.mesh);
  for (const int i : {0, 1}) {
    const View& view_j = scene.views[1 - i];
    const Warped warped = Compute(scene, i, 1 - i);
    size_t num_compared = 0;
    ForEachPixel(warped.tile, [&](int row, int col) {
      const size_t at = warped.tile.Index(row, col);
      if (warped.tile.is_valid[at] == 0) {
        EXPECT_EQ(warped.geometry.facets[at], kNone);
        EXPECT_EQ(warped.geometry.motion[at], 0);
        return;
      }
      const uint32_t facet = scene.drawn[i].facets[at];
      EXPECT_EQ(warped.geometry.facets[at], facet);
      EXPECT_EQ(warped.tile.image[at], scene.images[i].pixels[at]);
      const Vector3d point = scene.PointAt(i, facet, row, col);
      EXPECT_NEAR(
          warped.tile.inverse_depths[at] / scene.drawn[i].inverse_depths[at], 1,
          1e-6);
      const double depth = view_j.CamFromWorld(point).z();
      const DepthRange around =
          DepthsAround(bvh, view_j, SeenAt(view_j, point), 2.5);
      // Beside a border both sides are mixed.
      if (around.nearest > depth - 0.1 && around.farthest < depth + 0.1) {
        ++num_compared;
        EXPECT_NEAR(warped.tile.warped[at], warped.tile.image[at], 1.5);
      }
    });
    EXPECT_GT(num_compared, 0.4 * warped.tile.image.size());
  }
}

TEST(PairWarp, IsValidWhereBothViewsSeeTheFacet) {
  const WarpScene scene = MakeScene();
  const Bvh bvh(scene.mesh);
  for (const int i : {0, 1}) {
    const int j = 1 - i;
    const Warped warped = Compute(scene, i, j);
    int num_outside = 0;
    int num_hidden = 0;
    ForEachPixel(warped.tile, [&](int row, int col) {
      const size_t at = warped.tile.Index(row, col);
      const bool is_valid = warped.tile.is_valid[at] > 0;
      const uint32_t facet = scene.drawn[i].facets[at];
      if (facet == kNone) {
        EXPECT_FALSE(is_valid);
        return;
      }
      const Vector3d point = scene.PointAt(i, facet, row, col);
      const Vector2d pixel = SeenAt(scene.views[j], point);
      if (!(pixel.minCoeff() >= 0.5 &&
            pixel.x() <= scene.views[j].width - 0.5 &&
            pixel.y() <= scene.views[j].height - 0.5)) {
        ++num_outside;
        EXPECT_FALSE(is_valid);
        return;
      }
      const double depth = scene.views[j].CamFromWorld(point).z();
      const DepthRange first = DepthsAround(bvh, scene.views[j], pixel);
      if (first.nearest > depth - 0.15) {
        EXPECT_TRUE(is_valid);
      } else if (first.farthest < depth - 0.3) {
        ++num_hidden;
        EXPECT_FALSE(is_valid);
      }
    });
    EXPECT_GT(num_outside, 50);
    EXPECT_GT(num_hidden, 50);
  }
}

// A saturated pixel may stand for a brighter or a darker one.
TEST(PairWarp, LeavesOutSaturatedPixels) {
  WarpScene scene = MakeScene();
  const Warped before = Compute(scene, 0, 1);
  for (size_t i = 0; i < scene.images[0].pixels.size(); i += 3) {
    scene.images[0].pixels[i] = i % 2 == 0 ? 0 : 255;
  }
  const Warped after = Compute(scene, 0, 1);
  size_t num_saturated = 0;
  for (size_t i = 0; i < after.tile.is_valid.size(); ++i) {
    const bool is_saturated = IsSaturated(scene.images[0].pixels[i]);
    EXPECT_EQ(after.tile.is_valid[i],
              is_saturated ? 0 : before.tile.is_valid[i]);
    num_saturated += is_saturated && before.tile.is_valid[i] > 0 ? 1 : 0;
  }
  EXPECT_GT(num_saturated, 1000);
}

TEST(PairWarp, IsNotValidOnFacetsThatTurnAway) {
  WarpScene scene = MakeScene();
  const Warped before = Compute(scene, 0, 1);
  for (const int view : {0, 1}) {
    size_t num_left = 0;
    size_t num_lost = 0;
    for (const double min_cosine : {0.8, 0.9, 0.95, 0.98, 0.99}) {
      const double usual =
          std::exchange(scene.drawn[view].min_cosine, min_cosine);
      const Warped after = Compute(scene, 0, 1);
      for (size_t at = 0; at < after.tile.image.size(); ++at) {
        const uint32_t shown = before.geometry.facets[at];
        const bool is_left =
            shown != kNone &&
            IsFacing(scene.views[view], scene.mesh, scene.drawn[view], shown);
        EXPECT_EQ(after.geometry.facets[at], is_left ? shown : kNone);
        num_left += is_left ? 1 : 0;
        num_lost += shown != kNone && !is_left ? 1 : 0;
      }
      scene.drawn[view].min_cosine = usual;
    }
    EXPECT_GT(num_left, 1000);
    EXPECT_GT(num_lost, 1000);
  }
}

// The same facets, each with vertices of its own.
TriangleMesh Apart(const TriangleMesh& mesh) {
  return MakeTriangles(mesh.facets.size(), [&](uint32_t i, int k) {
    return mesh.vertices[mesh.facets[i][k]];
  });
}

// What is drawn stays, the facets move along their normals.
TEST(PairWarp, TellsHowImagesChangeAsTheSurfaceMoves) {
  WarpScene scene = MakeScene();
  scene.mesh = Apart(scene.mesh);
  const Warped warped = Compute(scene, 0, 1);
  const double step = 0.02 * 3 / 190;  // of a pixel's footprint
  const auto move = [&](double distance) {
    for (const Facet& facet : scene.mesh.facets) {
      const Vector3d normal = ComputeFacetFrame(scene.mesh, facet).normal;
      for (const uint32_t vertex : facet) {
        scene.mesh.vertices[vertex] += (distance * normal).cast<float>();
      }
    }
  };
  move(step);
  const Warped above = Compute(scene, 0, 1);
  move(-2 * step);
  const Warped below = Compute(scene, 0, 1);
  size_t num_compared = 0;
  double largest = 0;
  for (const float motion : warped.geometry.motion) {
    largest = std::max<double>(largest, std::abs(motion));
  }
  for (size_t at = 0; at < warped.tile.image.size(); ++at) {
    if (warped.tile.is_valid[at] > 0 && above.tile.is_valid[at] > 0 &&
        below.tile.is_valid[at] > 0) {
      ++num_compared;
      const double change =
          (above.tile.warped[at] - below.tile.warped[at]) / (2 * step);
      EXPECT_NEAR(warped.geometry.motion[at], change, 0.01 * largest);
    }
  }
  EXPECT_GT(num_compared, warped.tile.image.size() / 2);
}

// At the origin, and shifted, without rotation: before a plane at a depth of 2
// every pixel moves by the same fraction.
TEST(PairWarp, InterpolatesParabolasExactly) {
  const View view{"", 20, 20, 30, 30, 10, 10};
  View shifted = view;
  shifted.cam_from_world_translation = {0.15, -0.1, 0};
  const TriangleMesh plane = {{{-9, -9, 2}, {-9, 20, 2}, {20, -9, 2}},
                              {{0, 1, 2}}};
  WarpScene scene(plane, view, shifted);
  ForEachPixel(view, [&](int row, int col) {
    scene.images[1].pixels[row * 20 + col] =
        static_cast<uint8_t>(col * (col + 1) / 2 + 2 * row);
  });
  const Vector2d shift(0.15 * 30 / 2, -0.1 * 30 / 2);
  const Warped warped = Compute(scene, 0, 1);
  int num_compared = 0;
  ForEachPixel(view, [&](int row, int col) {
    const double x = col + shift.x();
    const double y = row + shift.y();
    const size_t at = warped.tile.Index(row, col);
    EXPECT_EQ(warped.tile.is_valid[at] > 0,
              x >= 0 && y >= 0 && x <= 19 && y <= 19);
    if (x >= 1 && y >= 1 && x <= 18 && y <= 18) {
      ++num_compared;
      EXPECT_NEAR(warped.tile.warped[at], x * (x + 1) / 2 + 2 * y, 1e-3);
      // As the plane comes nearer, all moves on by shift / 2 a unit.
      EXPECT_NEAR(warped.geometry.motion[at],
                  shift.x() / 2 * (x + 0.5) + shift.y() / 2 * 2, 1e-3);
    }
  });
  EXPECT_GT(num_compared, 200);
}

TEST(PairWarp, OfAnImageWithItselfIsThatImage) {
  const View view = MakeScene().views[0];
  const WarpScene scene(MakeScene().mesh, view, view);
  const Warped warped = Compute(scene, 0, 1);
  for (int row = 1; row + 1 < view.height; ++row) {
    for (int col = 1; col + 1 < view.width; ++col) {
      const size_t at = warped.tile.Index(row, col);
      EXPECT_EQ(warped.tile.is_valid[at] > 0,
                scene.drawn[0].facets[at] != kNone);
      if (warped.tile.is_valid[at] > 0) {
        EXPECT_NEAR(warped.tile.warped[at], warped.tile.image[at], 1e-2);
        EXPECT_NEAR(warped.geometry.motion[at], 0, 1e-3);
      }
    }
  }
}

TEST(PairWarp, OfATileIsThatPartOfTheWhole) {
  const WarpScene scene = MakeScene();
  const Warped whole = Compute(scene, 0, 1);
  for (const auto& [first_row, first_col] :
       {std::pair(-4, -3), {30, 40}, {100, -2}, {95, 120}, {200, 200}}) {
    const Warped part = Compute(scene.Warp(0, 1), first_row, first_col, 23, 31);
    ForEachPixel(part.tile, [&](int row, int col) {
      const size_t at = part.tile.Index(row, col);
      const int image_row = first_row + row;
      const int image_col = first_col + col;
      const bool is_inside = image_row >= 0 && image_col >= 0 &&
                             image_row < whole.tile.height &&
                             image_col < whole.tile.width;
      const size_t from =
          is_inside ? whole.tile.Index(image_row, image_col) : 0;
      ExpectPixel(part, at, whole, from, is_inside);
      if (is_inside) {
        EXPECT_EQ(part.tile.image[at], whole.tile.image[from]);
        EXPECT_EQ(part.tile.inverse_depths[at],
                  whole.tile.inverse_depths[from]);
      }
    });
  }
}

// The others are as if they showed nothing.
TEST(PairWarp, LeavesOutWhatNoWindowReaches) {
  const WarpScene scene = MakeScene();
  const Warped expected = Compute(scene, 0, 1);
  Warped warped;
  warped.tile.Resize(expected.tile.width, expected.tile.height);
  for (size_t i = 0; i < warped.tile.is_reached.size(); ++i) {
    warped.tile.is_reached[i] = i % 3 == 0 ? 1 : 0;
  }
  scene.Warp(0, 1).Compute(&warped.tile, &warped.geometry);
  for (size_t i = 0; i < warped.tile.is_reached.size(); ++i) {
    ExpectPixel(warped, i, expected, i, i % 3 == 0);
  }
}

}  // namespace colmap_ext::pair_warp_test
