#include "refine/remesh_for_images.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "refine/refinable_areas.h"
#include "tests/look_at.h"
#include "tests/mesh/same_topology.h"
#include "tests/mesh/shapes.h"
#include "tests/raster/visible_facets.h"

namespace colmap_ext {
namespace remesh_for_images_test {

constexpr double kMinCosine = 0.1;

// Two of the upper side, none of the lower.
std::vector<View> Views() {
  return {LookAt({0.5, 0.5, 4}, {0, 0, 0}, 320, 240, 300),
          LookAt({-0.8, 0.1, 4}, {0, 0, 0}, 320, 240, 300)};
}

struct Remeshed {
  TriangleMesh mesh;
  VertexAttributes attributes;
  std::vector<Eigen::Vector3f> origins;  // a shifted copy of the vertices
  FacetVisibility visibility;
};

const Eigen::Vector3f kShift(0.5F, -1, 2);

Remeshed Remesh(double area, const TriangleMesh& mesh) {
  Remeshed result{mesh, {}, mesh.vertices, {}};
  for (Eigen::Vector3f& origin : result.origins) {
    origin += kShift;
    result.attributes.views.AddRow(std::vector<uint32_t>{0, 1});
  }
  const auto draw = [](const TriangleMesh& drawn) {
    return std::make_shared<const VisibilityBuffers>(drawn, Views(), kMinCosine,
                                                     SIZE_MAX);
  };
  FixedSources fixed;
  result.visibility = RemeshForImages(
      area, draw, &result.mesh, &result.attributes, &result.origins, &fixed);
  return result;
}

TEST(RemeshForImages, GivesSeenFacetsTheAreaAndUnseenMore) {
  const TriangleMesh mesh = MakeBumpySphere(0.12F);
  for (const double area : {8.0, 25.0}) {
    const Remeshed result = Remesh(area, mesh);
    ExpectSameTopology(mesh, result.mesh);
    EXPECT_EQ(result.visibility,
              VisibleFacets(result.mesh, Views(), kMinCosine));
    const std::vector<float> areas =
        RefinableAreas(result.mesh, Views(), result.visibility);
    std::vector<float> seen;
    double seen_size = 0;
    double unseen_size = 0;
    size_t num_unseen = 0;
    for (size_t i = 0; i < areas.size(); ++i) {
      const auto& [a, b, c] = result.mesh.facets[i];
      const float edge =
          (result.mesh.vertices[b] - result.mesh.vertices[a]).norm();
      if (areas[i] > 0) {
        seen.push_back(areas[i]);
        seen_size += edge;
      } else if (result.mesh.vertices[c].z() < -0.5F) {
        unseen_size += edge;
        ++num_unseen;
      }
    }
    std::nth_element(seen.begin(), seen.begin() + seen.size() / 2, seen.end());
    EXPECT_NEAR(seen[seen.size() / 2] / area, 0.8, 0.4);
    ASSERT_GT(num_unseen, 10);
    EXPECT_GT(unseen_size / num_unseen, 1.5 * seen_size / seen.size());
  }
}

TEST(RemeshForImages, CarriesOriginsAndAttributes) {
  const Remeshed result = Remesh(10, MakeBumpySphere(0.12F));
  const size_t num_vertices = result.mesh.vertices.size();
  ASSERT_EQ(result.origins.size(), num_vertices);
  ASSERT_EQ(result.attributes.views.size(), num_vertices);
  for (size_t i = 0; i < num_vertices; ++i) {
    EXPECT_LT((result.origins[i] - kShift - result.mesh.vertices[i]).norm(),
              0.02F);
    EXPECT_EQ(result.attributes.views[i].size(), 2);
  }
}

// No more than there will be by far, and none too few where it matters: where
// the whole surface is seen and curved.
TEST(ExpectedFacets, AreAboutThoseOfTheRemeshedSurface) {
  const TriangleMesh mesh = MakeBumpySphere(0.12F);
  Rows<uint32_t> vertex_views;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    vertex_views.AddRow(std::vector<uint32_t>{0, 1});
  }
  for (const double area : {3.0, 12.0}) {
    const size_t expected = ExpectedFacets(area, mesh, vertex_views, Views());
    const size_t num_facets = Remesh(area, mesh).mesh.facets.size();
    EXPECT_LT(num_facets, expected);
    EXPECT_GT(6 * num_facets, expected);
  }
  EXPECT_EQ(ExpectedFacets(1e9, mesh, vertex_views, Views()),
            mesh.facets.size());
  const Rows<uint32_t> unseen(mesh.vertices.size());
  EXPECT_EQ(ExpectedFacets(1, mesh, unseen, Views()), mesh.facets.size());
}

}  // namespace remesh_for_images_test
}  // namespace colmap_ext
