#include "tests/synthetic/dense_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "base/percentile.h"
#include "mesh/topology.h"
#include "scene/half_pixel.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/pixels.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic::dense_scene_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

DenseSceneOptions Small(const std::string& shape, bool render_images = true) {
  DenseSceneOptions options;
  options.render_images = render_images;
  options.scene.shape = shape;
  options.scene.num_images = 8;
  options.scene.width = 100;
  options.scene.height = 75;
  options.scene.cell_size = 5;
  options.sparse.num_points = 300;
  return options;
}

// Signed distances of points from the surface along their normals, in pixels;
// 1e9 where there is no surface within 30.
std::vector<float> Distances(const DenseScene& scene,
                             const std::vector<Vector3f>& points) {
  const Bvh bvh(scene.scene.surface);
  const float pixel = scene.scene.footprint;
  std::vector<float> distances;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3f& normal = scene.fused.normals[i];
    RayPacket rays;
    rays.origin = points[i] - 30 * pixel * normal;
    rays.max_distance = 60;
    float nearest = 1e9f;
    for (int k = 0; k < 4; ++k) {
      rays.SetDirection(k, pixel * normal);
    }
    while (rays.min_distance < 60) {
      const HitPacket hit = bvh.Intersect(rays);
      if (hit.facet[0] < 0) {
        break;
      }
      const float distance = 30 - hit.distance[0];
      nearest = std::abs(distance) < std::abs(nearest) ? distance : nearest;
      rays.min_distance = hit.distance[0] + 1e-3f;
    }
    distances.push_back(nearest);
  }
  return distances;
}

double MedianSize(std::vector<float> values) {
  for (float& value : values) {
    value = std::abs(value);
  }
  return Median(&values);
}

// Least squares solution for the slope of a line through the origin.
double Slope(const std::vector<float>& x, const std::vector<float>& y) {
  double xx = 0, xy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    if (std::abs(y[i]) < 5) {
      xx += x[i] * x[i];
      xy += x[i] * y[i];
    }
  }
  return xy / xx;
}

TEST(MakeDenseScene, SameSeedSameBytesWhateverTheThreads) {
  for (const char* shape : {"statue", "wall", "grid"}) {
    DenseSceneOptions options = Small(shape);
    options.scene.width = 80;
    options.scene.height = 60;
    options.scene.untextured = options.scene.gloss = 0.8;
    options.keep_depth_maps = true;
    options.scene.num_threads = 1;
    const DenseScene a = MakeDenseScene(options);
    options.scene.num_threads = 3;
    const DenseScene b = MakeDenseScene(options);
    EXPECT_EQ(a.scene.surface, b.scene.surface);
    EXPECT_EQ(a.scene.irradiance, b.scene.irradiance);
    for (size_t i = 0; i < a.images.size(); ++i) {
      EXPECT_EQ(a.images[i].pixels, b.images[i].pixels);
      EXPECT_EQ(a.visible[i].depths, b.visible[i].depths);
      EXPECT_EQ(a.depth_maps[i].depths, b.depth_maps[i].depths);
      EXPECT_EQ(a.depth_maps[i].normals, b.depth_maps[i].normals);
    }
    EXPECT_GT(a.fused.cloud.size(), 50);
    EXPECT_EQ(a.fused.cloud.positions, b.fused.cloud.positions);
    EXPECT_EQ(a.fused.cloud.colors, b.fused.cloud.colors);
    EXPECT_EQ(a.fused.cloud.views, b.fused.cloud.views);
    EXPECT_TRUE(a.sparse_points == b.sparse_points);
    options.scene.seed = 2;
    const DenseScene c = MakeDenseScene(options);
    EXPECT_NE(a.fused.cloud.positions, c.fused.cloud.positions);
    EXPECT_NE(a.images[0].pixels, c.images[0].pixels);
  }
}

TEST(MakeDenseScene, PointsLieOnTheSurfaceUpToNoiseAndHalfPixel) {
  for (const char* shape : {"statue", "wall"}) {
    DenseSceneOptions options = Small(shape, /*render_images=*/false);
    options.scene.width = 160;
    options.scene.height = 120;
    options.fusion.outliers = 0;
    const DenseScene noisy = MakeDenseScene(options);
    EXPECT_LT(MedianSize(Distances(noisy, noisy.fused.cloud.positions)), 0.7);
    options.stereo.noise = options.stereo.fattening = 0;
    const DenseScene clean = MakeDenseScene(options);
    const std::vector<Vector3f>& points = clean.fused.cloud.positions;
    const std::vector<Vector3f> offsets =
        HalfPixelOffsets(clean.fused.cloud, clean.scene.views);
    std::vector<Vector3f> corrected;
    std::vector<float> predicted;
    for (size_t i = 0; i < points.size(); ++i) {
      corrected.push_back(points[i] + offsets[i]);
      predicted.push_back(-offsets[i].dot(clean.fused.normals[i]) /
                          clean.scene.footprint);
    }
    const std::vector<float> distances = Distances(clean, points);
    EXPECT_LT(MedianSize(Distances(clean, corrected)), 0.25);
    EXPECT_LT(MedianSize(Distances(clean, corrected)),
              0.75 * MedianSize(distances));
    // The prediction is of first order, and a mean; the offset is larger where
    // all views look from one side.
    EXPECT_GT(Slope(predicted, distances), 0.7);
    EXPECT_LT(Slope(predicted, distances), 1.8);
  }
}

// Whether anything lies between two points, `margin` scene units at both ends
// left out.
bool IsOccluded(const Bvh& bvh, const Vector3f& a, const Vector3f& b,
                float margin) {
  RayPacket rays;
  rays.origin = a;
  for (int i = 0; i < 4; ++i) {
    rays.SetDirection(i, (b - a).normalized());
  }
  rays.min_distance = margin;
  rays.max_distance = (b - a).norm() - margin;
  return bvh.Intersect(rays).facet[0] >= 0;
}

TEST(MakeDenseScene, PointsAreSeenByTheirViews) {
  for (const char* shape : {"statue", "wall"}) {
    DenseSceneOptions options = Small(shape, /*render_images=*/false);
    options.fusion.outliers = 0;
    const DenseScene scene = MakeDenseScene(options);
    const PointCloud& cloud = scene.fused.cloud;
    const Bvh bvh(scene.scene.surface);
    size_t num_observations = 0, num_occluded = 0;
    for (size_t i = 0; i < cloud.size(); i += 7) {
      for (const uint32_t index : cloud.views[i]) {
        const View& view = scene.scene.views[index];
        const Vector3d p = view.CamFromWorld(cloud.positions[i].cast<double>());
        ASSERT_GT(p.z(), 0);
        const Eigen::Vector2d pixel = view.ImageFromCam(p);
        EXPECT_GT(pixel.minCoeff(), -3);
        EXPECT_LT(pixel.x(), view.width + 3);
        EXPECT_LT(pixel.y(), view.height + 3);
        ++num_observations;
        num_occluded +=
            IsOccluded(bvh, view.Center().cast<float>(), cloud.positions[i],
                       5 * scene.scene.footprint);
      }
    }
    EXPECT_LT(num_occluded, 0.01 * num_observations);
  }
}

TEST(MakeDenseScene, OutliersAreOffTheSurface) {
  DenseSceneOptions options = Small("statue", /*render_images=*/false);
  options.fusion.outliers = 0.1;
  const DenseScene scene = MakeDenseScene(options);
  const std::vector<char>& is_outlier = scene.fused.is_outlier;
  const size_t num_outliers = std::ranges::count(is_outlier, 1);
  EXPECT_NEAR(num_outliers, 0.1 * (is_outlier.size() - num_outliers), 1);
  const std::vector<float> distances =
      Distances(scene, scene.fused.cloud.positions);
  size_t num_off = 0;
  for (size_t i = 0; i < distances.size(); ++i) {
    num_off += is_outlier[i] && std::abs(distances[i]) > 1;
  }
  EXPECT_GT(num_off, 0.7 * num_outliers);
}

TEST(MakeDenseScene, SparsePointsFitTheirFeatures) {
  const DenseScene scene = MakeDenseScene(Small("wall"));
  ASSERT_GT(scene.sparse_points.size(), 120);
  for (const SparsePoint& point : scene.sparse_points) {
    EXPECT_GE(point.track.size(), 3);
    EXPECT_LT(point.error, 2);
    for (const Feature& feature : point.track) {
      const View& view = scene.scene.views[feature.view];
      const Eigen::Vector2d pixel =
          view.ImageFromCam(view.CamFromWorld(point.position));
      EXPECT_LT((pixel - feature.position).norm(), 3);
    }
  }
}

TEST(MakeDenseScene, ForegroundGrowsOverWhatIsBehindIt) {
  DenseSceneOptions options = Small("grid", /*render_images=*/false);
  options.keep_depth_maps = true;
  options.stereo.noise = 0;
  for (const double fattening : {0.0, 5.0}) {
    options.stereo.fattening = fattening;
    const DenseScene scene = MakeDenseScene(options);
    size_t num_depths = 0, num_nearer = 0, num_farther = 0;
    for (size_t i = 0; i < scene.visible.size(); ++i) {
      const std::vector<float>& truth = scene.visible[i].depths;
      for (size_t k = 0; k < truth.size(); ++k) {
        const float depth = scene.depth_maps[i].depths[k];
        if (depth > 0 && truth[k] > 0) {
          ++num_depths;
          num_nearer += depth < 0.95f * truth[k];
          num_farther += depth > 1.05f * truth[k];
        }
      }
    }
    EXPECT_EQ(num_farther, 0);
    EXPECT_EQ(num_nearer > 0.01 * num_depths, fattening > 0);
    EXPECT_LT(num_nearer, 0.15 * num_depths);
  }
}

// The share of the pixels that see a patch that get a depth.
double ShareOfDepths(const DenseScene& scene, Patch patch) {
  patch.strength = 1;
  size_t num_pixels = 0, num_depths = 0;
  for (size_t i = 0; i < scene.visible.size(); ++i) {
    const View& view = scene.scene.views[i];
    const Visible& visible = scene.visible[i];
    ForEachPixel(visible, [&](int row, int col) {
      const size_t index = visible.Index(row, col);
      const Vector3f point =
          view.Center().cast<float>() +
          visible.depths[index] * RayDirection(view, col + 0.5, row + 0.5);
      if (patch.At(point) >= 1) {
        ++num_pixels;
        num_depths += scene.depth_maps[i].depths[index] > 0;
      }
    });
  }
  return static_cast<double>(num_depths) / num_pixels;
}

TEST(MakeDenseScene, StereoFailsWhereItIsBlankOrShines) {
  for (const char* shape : {"wall", "grid"}) {
    DenseSceneOptions options = Small(shape, /*render_images=*/false);
    options.keep_depth_maps = true;
    const DenseScene plain = MakeDenseScene(options);
    options.scene.untextured = 1;
    options.scene.gloss = 2;
    const DenseScene hard = MakeDenseScene(options);
    EXPECT_LT(ShareOfDepths(hard, hard.scene.blank),
              0.6 * ShareOfDepths(plain, plain.scene.blank));
    EXPECT_LT(ShareOfDepths(hard, hard.scene.shiny),
              0.99 * ShareOfDepths(plain, plain.scene.shiny));
  }
}

TEST(MakeDenseScene, HighlightsMoveWithTheEye) {
  Scene scene;
  scene.shiny = {Vector3f::Zero(), 1, 0.5f};
  const Vector3f normal = Vector3f::UnitZ();
  scene.to_sun = Vector3f(-1, 0, 1).normalized();
  EXPECT_FLOAT_EQ(Highlight(scene, {0, 0, 0}, normal, {5, 0, 5}), 0.5f);
  EXPECT_LT(Highlight(scene, {0, 0, 0}, normal, {0, 0, 5}), 0.1f);
  EXPECT_EQ(Highlight(scene, {2, 0, 0}, normal, {7, 0, 5}), 0);
}

TEST(MeshSolid, BallIsASphere) {
  Solid ball;
  ball.box = {Vector3f(-1, -1, -1), Vector3f(1, 1, 1)};
  ball.shape = [](const Vector3f& p) { return p.norm() - 0.7f; };
  ball.detail = [](const Vector3f&) { return 0.0f; };
  const TriangleMesh mesh = MeshSolid(ball, 0.06f);
  const MeshReport report = Analyze(mesh);
  EXPECT_TRUE(report.IsManifold()) << report.Defects();
  EXPECT_EQ(report.num_border_edges, 0);
  EXPECT_EQ(report.euler, 2);
  for (const Vector3f& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.norm(), 0.7f, 1e-3f);
  }
  EXPECT_NEAR(Volume(mesh), 4 / 3.0 * std::numbers::pi * 0.343, 0.01);
}

TEST(MeshSolid, NoiseIsManifold) {
  for (uint32_t seed = 0; seed < 5; ++seed) {
    Solid solid;
    solid.box = {Vector3f(-1, -1, -1), Vector3f(1, 1, 1)};
    solid.shape = [seed](const Vector3f& p) {
      return 0.3f * ValueNoise(3 * p, seed);
    };
    solid.max_detail = 0.1f;
    solid.detail = [seed](const Vector3f& p) {
      return 0.1f * ValueNoise(20 * p, seed + 1);
    };
    const MeshReport report = Analyze(MeshSolid(solid, 0.1f));
    EXPECT_GT(report.num_facets, 100);
    EXPECT_TRUE(report.IsManifold()) << report.Defects();
  }
}

SceneOptions OfOneImage(const std::string& shape) {
  SceneOptions options;
  options.shape = shape;
  options.num_images = 1;
  options.width = 120;
  options.height = 90;
  options.cell_size = 2.5;
  return options;
}

// The surface is manifold, and in one piece with one border.
MeshReport ExpectOnePiece(const SceneOptions& options) {
  const MeshReport report = Analyze(MakeScene(options).surface);
  EXPECT_TRUE(report.IsManifold()) << report.Defects();
  EXPECT_EQ(report.num_components, 1);
  EXPECT_EQ(report.num_border_loops, 1);
  return report;
}

TEST(MakeScene, StatueHasOneHandleAndTheWallIsOnePieceWithABorder) {
  EXPECT_EQ(ExpectOnePiece(OfOneImage("statue")).genus, 1);
  ExpectOnePiece(OfOneImage("wall"));
}

TEST(MakeScene, GridIsOnePieceWithAHandleForEachLoopOfItsRods) {
  SceneOptions options = OfOneImage("grid");
  options.thickness = 3;  // as the cells are large
  options.cell_size = 2;
  // Six meshes of the lattice; four posts, the first of which closes none; the
  // gable.
  EXPECT_EQ(ExpectOnePiece(options).genus, 6 + 3 + 1);
}

TEST(MakeScene, RefusesOtherShapes) {
  EXPECT_THROW(MakeScene(OfOneImage("teapot")), std::invalid_argument);
}

}  // namespace colmap_ext::synthetic::dense_scene_test
