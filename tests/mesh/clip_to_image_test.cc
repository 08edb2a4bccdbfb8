#include "mesh/mesh_in_image.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace clip_to_image_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

// At the origin.
View MakeView() { return LookAt({0, 0, 0}, {1, 2, 3}, 64, 48, 50); }

// All around the camera.
TriangleMesh RandomTriangle(Random* random) {
  TriangleMesh mesh{{}, {{0, 1, 2}}};
  for (int k = 0; k < 3; ++k) {
    mesh.vertices.emplace_back(4 * RandomPoint(random).array() - 2);
  }
  return mesh;
}

bool IsMet(const View& view, const TriangleMesh& mesh, const Vector2d& pixel) {
  const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[0]);
  Eigen::Matrix3d matrix;
  matrix << b - a, c - a, -(view.RayFromPixel() * pixel.homogeneous());
  const Vector3d x = matrix.inverse() * (view.Center() - a);
  return x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && x[2] > 0;
}

// px^2, of the image
double AreaByRays(const View& view, const TriangleMesh& mesh) {
  constexpr int kRays = 4;  // a pixel, along u and v
  double area = 0;
  for (int i = 0; i < kRays * view.width; ++i) {
    for (int j = 0; j < kRays * view.height; ++j) {
      area += IsMet(view, mesh, Vector2d(i + 0.5, j + 0.5) / kRays) ? 1 : 0;
    }
  }
  return area / (kRays * kRays);
}

double Cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

TEST(ClipToImage, LeavesWhatRaysOfTheImageMeet) {
  Random random(1);
  const View view = MakeView();
  int num_parts = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const TriangleMesh mesh = RandomTriangle(&random);
    const std::vector<Vector3d> part =
        ClipToImage(view, mesh, mesh.facets[0], ImageBox(view));
    std::vector<Vector2d> pixels;
    for (const Vector3d& corner : part) {
      EXPECT_GT(corner.z(), 0);
      pixels.push_back(view.ImageFromCam(corner));
      EXPECT_GT(pixels.back().minCoeff(), -1e-6);
      EXPECT_LT(pixels.back().x(), view.width + 1e-6);
      EXPECT_LT(pixels.back().y(), view.height + 1e-6);
    }
    double area = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
      area += Cross(pixels[k], pixels[(k + 1) % pixels.size()]) / 2;
    }
    EXPECT_NEAR(std::abs(area), AreaByRays(view, mesh), 25) << trial;
    num_parts += part.empty() ? 0 : 1;
  }
  EXPECT_GT(num_parts, 15);
}

// Also of one that is seen from its edge, or through the camera's centre.
TEST(ClipToImage, LeavesNothingOfWhatLiesBehindOrAtTheCamera) {
  const View view{"", 64, 48, 1, 1, 32, 24};
  for (const std::vector<Eigen::Vector3f>& corners :
       {std::vector<Eigen::Vector3f>{{-1, -1, -1}, {1, -1, -1}, {0, 1, -2}},
        {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
        {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}}) {
    const TriangleMesh mesh{corners, {{0, 1, 2}}};
    EXPECT_TRUE(
        ClipToImage(view, mesh, mesh.facets[0], ImageBox(view)).empty());
    EXPECT_EQ(AreaInImage(mesh, mesh.facets[0], view), 0);
  }
}

TEST(AreaInImage, OfAFacetThatReachesBehindIsThatOfWhatTheImageShows) {
  Random random(2);
  const View view = MakeView();
  int num_seen = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleMesh mesh = RandomTriangle(&random);
    int num_before = 0;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      num_before += view.CamFromWorld(vertex.cast<double>()).z() > 0 ? 1 : 0;
    }
    if (num_before == 1 || num_before == 2) {
      const double area = AreaInImage(mesh, mesh.facets[0], view);
      EXPECT_NEAR(area, AreaByRays(view, mesh), 25) << trial;
      num_seen += area > 100 ? 1 : 0;
    }
  }
  EXPECT_GT(num_seen, 5);
}

TEST(Footprints, AreThoseOfTheNearestViews) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 4}, {0, 0, 8}, {1, 0, 6}};
  View view;  // at the origin, along z
  view.fx = view.fy = 2;
  View near = view;
  near.cam_from_world_translation = {0, 0, -2};
  Rows<uint32_t> vertex_views;
  vertex_views.AddRow(std::vector<uint32_t>{0, 1});
  vertex_views.AddRow(std::vector<uint32_t>{0});
  vertex_views.EndRow();
  EXPECT_EQ(Footprints(mesh, vertex_views, {view, near}),
            (std::vector<float>{1, 4, 2}));
  EXPECT_EQ(MedianFootprint(mesh, vertex_views, {view, near}), 2);
  EXPECT_EQ(Footprints(mesh, Rows<uint32_t>(3), {view}),
            (std::vector<float>{0, 0, 0}));
}

}  // namespace clip_to_image_test
}  // namespace colmap_ext
