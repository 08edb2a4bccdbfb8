#include "meshing/manifold_meshing.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "scene/view.h"
#include "spatial/self_intersections.h"
#include "tests/delaunay/random_complex.h"
#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/texts.h"
#include "tests/threads.h"

namespace colmap_ext::manifold_meshing_test {

View LookAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  return LookAtView(center, target, Eigen::Vector3d::UnitZ(), 1000, 1000, 1000);
}

// A unit sphere with noise, seen by the cameras that are before it. They also
// see some of the corners of the room that they are in, past the sphere, if
// there is one.
struct SphereScene {
  static constexpr double kNoise = 0.005;

  explicit SphereScene(uint32_t num_points = 4000, bool has_room = true) {
    Random random(1);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d center = 4 * RandomNormal(&random);
      views.push_back(LookAt(center, Eigen::Vector3d::Zero()));
    }
    for (const Eigen::Vector3f& corner : GridPoints(has_room ? 2 : 0)) {
      const Eigen::Vector3d point =
          20 * (corner.cast<double>().array() - 0.5).matrix();
      Add(point, [&](const Eigen::Vector3d& center) {
        const Eigen::Vector3d ray = (point - center).normalized();
        return center.cross(ray).norm() > 1.1 || center.dot(ray) > 0;
      });
    }
    for (uint32_t i = 0; i < num_points; ++i) {
      const Eigen::Vector3d normal = RandomNormal(&random);
      const Eigen::Vector3d point =
          normal * (1 + kNoise * (2 * random.Unit() - 1));
      Add(point, [&](const Eigen::Vector3d& center) {
        return (center - point).dot(normal) > 1;
      });
    }
  }

  template <typename IsSeen>
  void Add(const Eigen::Vector3d& point, const IsSeen& is_seen) {
    cloud.colors.push_back({static_cast<uint8_t>(cloud.size()), 100, 200});
    cloud.positions.push_back(point.cast<float>());
    for (uint32_t view = 0; view < views.size(); ++view) {
      if (is_seen(views[view].Center())) {
        cloud.views.values.push_back(view);
      }
    }
    cloud.views.EndRow();
  }

  ManifoldMesh Mesh(const ManifoldMeshingOptions& options) const {
    return MeshManifold(options, cloud, views);
  }

  // All of it, cameras included, scaled by a power of two.
  void Scale(float factor) {
    for (Eigen::Vector3f& position : cloud.positions) {
      position *= factor;
    }
    views = Scaled(views, factor);
  }

  PointCloud cloud;
  std::vector<View> views;
};

// What has to be the same of two results.
auto PartsOf(const ManifoldMesh& mesh) {
  const VertexAttributes& attributes = mesh.attributes;
  return std::tuple(mesh.mesh.vertices, mesh.mesh.facets, attributes.colors,
                    attributes.views, attributes.confidences,
                    mesh.facet_confidences, mesh.report.flow);
}

// Options that keep all points.
ManifoldMeshingOptions KeepAll() {
  ManifoldMeshingOptions options;
  options.thinning.max_proj_dist = 0;
  return options;
}

std::vector<ManifoldMeshingOptions> Variants() {
  std::vector<ManifoldMeshingOptions> variants(6);
  variants[1].thinning.max_proj_dist = 0;
  variants[2].preemptive_fixing = false;
  variants[3].fixing_rule = FixingRule::kPaper;
  variants[4].alpha_kind = ObservationWeight::kConstant;
  variants[4].alpha_vis = 0.5;
  variants[4].behind_sigma = 8;
  variants[5].max_side_length_factor = 1;
  variants[5].max_side_length_percentile = 60;
  variants[5].min_component_faces = 20;
  return variants;
}

TEST(MeshManifold, OfASphereIsOneSphere) {
  const SphereScene scene;
  for (const double max_proj_dist : {0.0, 20.0}) {
    ManifoldMeshingOptions options;
    options.thinning.max_proj_dist = max_proj_dist;
    const ManifoldMesh result = scene.Mesh(options);
    EXPECT_TRUE(HasManifoldLinks(result.mesh));
    const MeshReport& report = result.report.mesh;
    EXPECT_EQ(report.num_components, 1u);
    EXPECT_EQ(report.num_border_edges, 0u);
    EXPECT_EQ(report.genus, 0);
    double mean_error = 0;
    for (const Facet& facet : result.mesh.facets) {
      const Eigen::Vector3f centroid = CentroidOf(result.mesh, facet);
      EXPECT_NEAR(centroid.norm(), 1, 0.1);
      mean_error += std::abs(centroid.norm() - 1) /
                    static_cast<double>(result.mesh.facets.size());
    }
    EXPECT_LT(mean_error, SphereScene::kNoise);
    EXPECT_NEAR(Volume(result.mesh), 4.19, 0.1);  // positive: seen from outside
  }
}

// Within the region, away from its border, the surface is the same as without.
TEST(MeshManifold, EndsAtTheRegion) {
  const SphereScene scene;
  ManifoldMeshingOptions options = KeepAll();
  options.region = RegionBetween({-2, -2, -2}, {2, 2, 0.3});
  const ManifoldMesh result = scene.Mesh(options);
  EXPECT_TRUE(HasManifoldLinks(result.mesh));
  EXPECT_EQ(result.report.mesh.num_components, 1u);
  EXPECT_EQ(result.report.mesh.num_border_loops, 1u);
  EXPECT_GT(result.report.num_outside_points, 0u);
  EXPECT_EQ(result.attributes.views.size(), result.mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : result.mesh.vertices) {
    EXPECT_LE(vertex.z(), 0.3f + 1e-6f);
    EXPECT_NEAR(vertex.norm(), 1, 0.1);
  }
  options.region = RegionBetween({5, 5, 5}, {6, 6, 6});
  EXPECT_THROW(scene.Mesh(options), std::invalid_argument);
}

// Few points lie in the region; the rays to others pass through it.
TEST(MeshManifold, RefusesRegionsOfAFewPoints) {
  const SphereScene scene;
  ManifoldMeshingOptions options = KeepAll();
  size_t num_alone = 0;
  for (uint32_t point = 8; point < 30; ++point) {
    const Eigen::Vector3d center = scene.cloud.positions[point].cast<double>();
    const Eigen::Vector3d half_size = Eigen::Vector3d::Constant(0.01);
    options.region = RegionBetween(center - half_size, center + half_size);
    num_alone += 1 == std::ranges::count_if(
                          scene.cloud.positions, [&](const auto& position) {
                            return options.region->Contains(position);
                          });
    EXPECT_TRUE(
        Has(MessageOf<std::invalid_argument>([&] { scene.Mesh(options); }),
            "to mesh"))
        << point;
  }
  EXPECT_GT(num_alone, 0u);
}

// Rays through the middle of the sphere, with more weight than all its points,
// leave little matter within.
TEST(MeshManifold, RaysBeyondCarve) {
  const SphereScene scene;
  ManifoldMeshingOptions options = KeepAll();
  RayEnds ends;
  for (const View& view : scene.views) {
    const Eigen::Vector3d center = view.Center();
    // Through the sphere's middle and on.
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d through(0.02 * (i % 7 - 3), 0.02 * (i % 5 - 2),
                                    0.02 * (i % 3 - 1));
      ends.push_back({(center + 2 * (through - center)).cast<float>(),
                      static_cast<uint32_t>(&view - scene.views.data()), 1000});
    }
  }
  const ManifoldMesh carved =
      MeshManifold(options, scene.cloud, scene.views, {}, ends);
  EXPECT_TRUE(HasManifoldLinks(carved.mesh));
  EXPECT_EQ(carved.report.num_ray_ends, ends.size());
  EXPECT_LT(Volume(carved.mesh), 0.5 * Volume(scene.Mesh(options).mesh));
  // No facet is at an end.
  for (const Eigen::Vector3f& vertex : carved.mesh.vertices) {
    EXPECT_LT(vertex.norm(), 1.3f);
  }
}

TEST(MeshManifold, HasNoHolesWhereTheObjectIsTheHull) {
  for (const uint32_t num_points : {500, 4000}) {
    const SphereScene scene(num_points, false);
    for (const double behind_sigma : {1.0, 3.0}) {
      ManifoldMeshingOptions options = KeepAll();
      options.behind_sigma = behind_sigma;
      const MeshReport report = scene.Mesh(options).report.mesh;
      EXPECT_EQ(report.num_components, 1u);
      EXPECT_EQ(report.num_border_edges, 0u)
          << num_points << " " << behind_sigma;
      EXPECT_EQ(report.genus, 0);
    }
  }
}

// The sphere's points but those of its top, which nobody sees.
PointCloud WithoutTop(const PointCloud& cloud) {
  PointCloud rest;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& position = cloud.positions[i];
    if (position.norm() > 2 || position.z() < 0.7) {
      rest.positions.push_back(position);
      rest.colors.push_back(cloud.colors[i]);
      rest.views.AddRow(cloud.views[i]);
    }
  }
  return rest;
}

TEST(MeshManifold, TrimsWhatNoPointBearsOutAndClosesIt) {
  const SphereScene scene;
  const PointCloud cloud = WithoutTop(scene.cloud);
  ManifoldMeshingOptions options = KeepAll();
  const ManifoldMesh whole = MeshManifold(options, cloud, scene.views);
  ASSERT_EQ(whole.report.mesh.num_border_loops, 0);
  options.borders.trim = 0.2;
  const ManifoldMesh trimmed = MeshManifold(options, cloud, scene.views);
  EXPECT_TRUE(trimmed.report.mesh.IsManifold());
  const size_t num_loops = trimmed.report.mesh.num_border_loops;
  EXPECT_GT(num_loops, 0);
  EXPECT_GT(trimmed.mesh.facets.size(), 0.9 * whole.mesh.facets.size());
  for (const Facet& facet : trimmed.mesh.facets) {
    EXPECT_LT(CentroidOf(trimmed.mesh, facet).z(), 0.75);
  }
  options.borders.close_holes = kAllLoops;
  const ManifoldMesh closed = MeshManifold(options, cloud, scene.views);
  EXPECT_EQ(closed.report.mesh.num_border_loops, 0);
  EXPECT_EQ(closed.report.mesh.euler, 2);
  EXPECT_EQ(closed.report.borders.holes.num_closed, num_loops);
  ASSERT_EQ(closed.facet_confidences.size(), closed.mesh.facets.size());
  ASSERT_EQ(closed.attributes.views.size(), closed.mesh.vertices.size());
  EXPECT_EQ(closed.facet_confidences.back(), 0);
}

TEST(MeshManifold, ReportsWhatItDid) {
  const SphereScene scene;
  for (const ManifoldMeshingOptions& options : Variants()) {
    const ManifoldMesh result = scene.Mesh(options);
    const ManifoldMeshingReport& report = result.report;
    EXPECT_TRUE(HasManifoldLinks(result.mesh));
    EXPECT_TRUE(report.mesh.IsManifold());
    EXPECT_EQ(report.num_points, scene.cloud.size());
    EXPECT_EQ(report.num_observations, scene.cloud.views.values.size());
    // Those of points that were thinned out to one vertex are one.
    EXPECT_LE(report.rays.num_rays, report.num_observations);
    EXPECT_GT(report.rays.num_rays, report.num_observations / 2);
    EXPECT_TRUE(options.thinning.max_proj_dist > 0 ||
                report.rays.num_rays == report.num_observations);
    EXPECT_EQ(report.rays.num_lost_rays, 0u);
    EXPECT_EQ(report.flow, report.cut);
    EXPECT_GT(report.flow, 0);
    EXPECT_GT(report.num_free_cells, 0u);
    EXPECT_LT(report.num_free_cells, report.num_cells);
    EXPECT_GT(report.distance_sigma, 0);
    EXPECT_EQ(report.num_vertices == scene.cloud.size(),
              options.thinning.max_proj_dist == 0);
    EXPECT_EQ(report.mesh.num_vertices, result.mesh.vertices.size());
    EXPECT_EQ(report.mesh.num_facets, result.mesh.facets.size());
    EXPECT_EQ(result.attributes.colors.size(), result.mesh.vertices.size());
    ASSERT_EQ(result.facet_confidences.size(), result.mesh.facets.size());
    ASSERT_EQ(result.attributes.confidences.size(),
              result.mesh.vertices.size());
    for (const float confidence : result.attributes.confidences) {
      EXPECT_GE(confidence, 0);
      EXPECT_LE(confidence, 1);
    }
    EXPECT_EQ(result.attributes.views.size(), result.mesh.vertices.size());
    EXPECT_GT(report.num_long_facets, 0u);  // of the room
    EXPECT_EQ(report.self_intersections.num_after, 0u);
    EXPECT_TRUE(FindSelfIntersections(result.mesh).empty());
  }
}

// Vertices are points, and have their colours and views.
TEST(MeshManifold, VerticesHaveWhatTheirPointsHave) {
  const SphereScene scene;
  ManifoldMeshingOptions options;
  options.smoothing = 0;
  options.preemptive_fixing = false;  // no centroids
  const ManifoldMesh result = scene.Mesh(options);
  ASSERT_EQ(result.report.num_midpoints, 0u);
  for (size_t i = 0; i < result.mesh.vertices.size(); ++i) {
    const auto found =
        std::ranges::find(scene.cloud.positions, result.mesh.vertices[i]);
    ASSERT_NE(found, scene.cloud.positions.end());
    const auto point =
        static_cast<size_t>(found - scene.cloud.positions.begin());
    ASSERT_EQ(result.attributes.colors[i], scene.cloud.colors[point]);
    ASSERT_TRUE(std::ranges::equal(result.attributes.views[i],
                                   scene.cloud.views[point]));
  }
}

TEST(MeshManifold, DoesNotDependOnThreads) {
  const SphereScene scene(2500);
  for (const ManifoldMeshingOptions& options : Variants()) {
    ExpectSameForAnyThreads([&] { return PartsOf(scene.Mesh(options)); });
  }
}

TEST(MeshManifold, ScalesWithTheScene) {
  const SphereScene scene(1500);
  for (const ManifoldMeshingOptions& options : Variants()) {
    ManifoldMesh expected = scene.Mesh(options);
    for (const float factor : {1024.0f, 1.0f / 1024}) {
      SphereScene scaled = scene;
      scaled.Scale(factor);
      const ManifoldMesh result = scaled.Mesh(options);
      ManifoldMesh expected_scaled = expected;
      expected_scaled.mesh = Scaled(expected.mesh, factor);
      EXPECT_TRUE(PartsOf(result) == PartsOf(expected_scaled));
    }
  }
}

TEST(MeshManifold, DuplicatesChangeNothingButTheirVotes) {
  SphereScene scene(1000);
  ManifoldMeshingOptions options = KeepAll();
  options.smoothing = 0;
  const ManifoldMesh expected = scene.Mesh(options);
  // Duplicates without views.
  for (int i = 0; i < 100; ++i) {
    scene.cloud.positions.push_back(scene.cloud.positions[7 * i]);
    scene.cloud.colors.push_back({1, 2, 3});
    scene.cloud.views.EndRow();
  }
  const ManifoldMesh result = scene.Mesh(options);
  EXPECT_TRUE(PartsOf(result) == PartsOf(expected));
  EXPECT_EQ(result.report.num_duplicate_points, 100u);
}

TEST(MeshManifold, ReportsItsProgress) {
  const SphereScene scene(1000);
  std::vector<std::string> stages;
  double last_share = 0;
  MeshManifold({}, scene.cloud, scene.views,
               [&](std::string_view stage, double share) {
                 if (stages.empty() || stages.back() != stage) {
                   EXPECT_EQ(share, 0) << stage;
                   stages.emplace_back(stage);
                 } else {
                   EXPECT_GE(share, last_share) << stage;
                 }
                 EXPECT_LE(share, 1) << stage;
                 last_share = share;
               });
  EXPECT_GT(stages.size(), 4u);
  // No stage comes twice.
  std::ranges::sort(stages);
  EXPECT_EQ(std::unique(stages.begin(), stages.end()), stages.end());
}

// That the input is refused with a message, rather than meshed.
void ExpectRefused(const PointCloud& cloud, const std::vector<View>& views) {
  for (const ManifoldMeshingOptions& options :
       {ManifoldMeshingOptions(), KeepAll()}) {
    EXPECT_NE(MessageOf<std::invalid_argument>(
                  [&] { MeshManifold(options, cloud, views); }),
              "");
  }
}

// Points that one camera sees.
PointCloud SeenCloud(const std::vector<Eigen::Vector3f>& points) {
  PointCloud cloud{points, {}, {}};
  for (size_t i = 0; i < points.size(); ++i) {
    cloud.views.AddRow(std::vector<uint32_t>{0});
  }
  return cloud;
}

TEST(MeshManifold, RefusesWhatCannotBeMeshed) {
  const std::vector<View> views = {LookAt({0, 0, -10}, {0, 0, 0})};
  std::vector<Eigen::Vector3f> plane;
  for (int i = 0; i < 100; ++i) {
    plane.emplace_back(i % 10, i / 10, 0);
  }
  ExpectRefused(PointCloud(), views);
  ExpectRefused(PointCloud(), {});
  ExpectRefused(SeenCloud({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), views);
  ExpectRefused(SeenCloud(plane), views);
  ExpectRefused(SeenCloud(std::vector<Eigen::Vector3f>(50, {1, 2, 3})), views);
  // Nobody sees any.
  ExpectRefused(CloudOf(GridPoints(4)), views);
}

// Difficult points and cameras in bad places: a manifold mesh, or a refusal.
TEST(MeshManifold, NeverCrashes) {
  size_t num_meshes = 0;
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    for (const Eigen::Vector3d& offset :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-9, 0, 0),
          Eigen::Vector3d(0.5, 0, 0), Eigen::Vector3d(0, 0, -1e7)}) {
      const Eigen::Vector3d center = points.back().cast<double>() + offset;
      const std::vector<View> views = {
          LookAt(center, center + Eigen::Vector3d(0.1, 0.2, 1))};
      for (ManifoldMeshingOptions options : Variants()) {
        options.max_side_length_factor = 0;
        try {
          const ManifoldMesh result =
              MeshManifold(options, SeenCloud(points), views);
          EXPECT_TRUE(HasManifoldLinks(result.mesh));
          EXPECT_FALSE(result.mesh.facets.empty());
          EXPECT_EQ(FindSelfIntersections(result.mesh).size(),
                    result.report.self_intersections.num_after);
          ++num_meshes;
        } catch (const std::invalid_argument& error) {
          EXPECT_STRNE(error.what(), "");
        }
      }
    }
  }
  EXPECT_GT(num_meshes, 20u);
}

}  // namespace colmap_ext::manifold_meshing_test
