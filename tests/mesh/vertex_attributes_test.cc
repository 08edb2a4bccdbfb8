#include "mesh/surface.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace vertex_attributes_test {

VertexAttributes RandomAttributes(uint32_t num_vertices, Random* random) {
  VertexAttributes attributes;
  for (uint32_t i = 0; i < num_vertices; ++i) {
    Color color;
    for (uint8_t& channel : color) {
      channel = static_cast<uint8_t>(random->Below(256));
    }
    attributes.colors.push_back(color);
    for (uint32_t view = 0; view < 6; ++view) {
      if (random->Chance(0.4)) {
        attributes.views.values.push_back(view);
      }
    }
    attributes.views.EndRow();
  }
  return attributes;
}

TEST(InterpolateAttributes, TakesMeanColorsAndTheViewsOfEither) {
  Random random(1);
  constexpr uint32_t kNumVertices = 30;
  const VertexAttributes attributes = RandomAttributes(kNumVertices, &random);
  std::vector<std::array<uint32_t, 2>> sources;
  for (int i = 0; i < 100; ++i) {
    sources.push_back({random.Below(kNumVertices), random.Below(kNumVertices)});
  }
  const VertexAttributes result = InterpolateAttributes(attributes, sources);
  ASSERT_EQ(result.colors.size(), sources.size());
  ASSERT_EQ(result.views.offsets.size(), sources.size() + 1);
  EXPECT_EQ(result.views.offsets.back(), result.views.values.size());
  for (size_t i = 0; i < sources.size(); ++i) {
    const auto& [a, b] = sources[i];
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(result.colors[i][k],
                  (attributes.colors[a][k] + attributes.colors[b][k]) / 2.0,
                  0.5);
    }
    std::set<uint32_t> expected;
    for (const uint32_t source : {a, b}) {
      const auto views = attributes.views[source];
      expected.insert(views.begin(), views.end());
    }
    EXPECT_TRUE(std::ranges::equal(result.views[i], expected));
  }
}

TEST(InterpolateAttributes, LeavesOldVerticesAsTheyAre) {
  Random random(2);
  const VertexAttributes attributes = RandomAttributes(20, &random);
  std::vector<std::array<uint32_t, 2>> sources;
  for (uint32_t i = 0; i < 20; ++i) {
    sources.push_back({i, i});
  }
  const VertexAttributes result = InterpolateAttributes(attributes, sources);
  EXPECT_EQ(result.colors, attributes.colors);
  EXPECT_EQ(result.views.offsets, attributes.views.offsets);
  EXPECT_EQ(result.views.values, attributes.views.values);
}

TEST(InterpolateAttributes, TakesMeanConfidencesAndMayGoWithoutColors) {
  VertexAttributes attributes;
  attributes.views = Rows<uint32_t>(3);
  const VertexAttributes result =
      InterpolateAttributes(attributes, {{0, 1}, {2, 2}});
  EXPECT_TRUE(result.colors.empty());
  EXPECT_TRUE(result.confidences.empty());
  EXPECT_EQ(result.views.size(), 2);
  attributes.confidences = {0.25f, 0.75f, 1.0f};
  EXPECT_EQ(InterpolateAttributes(attributes, {{0, 1}, {2, 2}}).confidences,
            (std::vector<float>{0.5f, 1.0f}));
}

// One a vertex of the cube, a little off, seen by views i and i + 1.
PointCloud PointsNearCube() {
  PointCloud points;
  for (uint32_t i = 0; i < 8; ++i) {
    points.positions.push_back(MakeCube().vertices[i] +
                               Eigen::Vector3f(0.01f, 0, 0));
    points.colors.push_back({static_cast<uint8_t>(i), 0, 255});
    points.views.values.insert(points.views.values.end(), {i, i + 1});
    points.views.EndRow();
  }
  return points;
}

TEST(NearestAttributesTest, TakesTheNearestColorAndTheViewsOfAFew) {
  const PointCloud points = PointsNearCube();
  const VertexAttributes attributes = NearestAttributes(MakeCube(), points);
  EXPECT_EQ(attributes.colors, points.colors);
  ASSERT_EQ(attributes.views.size(), 8);
  for (uint32_t i = 0; i < 8; ++i) {
    const auto views = attributes.views[i];
    EXPECT_TRUE(std::ranges::is_sorted(views, std::less_equal()));
    EXPECT_TRUE(std::ranges::binary_search(views, i));
    EXPECT_TRUE(std::ranges::binary_search(views, i + 1));
    EXPECT_LE(views.size(), 8);
  }
}

// Three mean lengths of a vertex's edges, an edge counting as often as it has
// facets; 0 without edges.
double Reach(const TriangleMesh& mesh, uint32_t vertex) {
  double sum = 0;
  double count = 0;
  for (const Facet& facet : mesh.facets) {
    const bool is_at = std::ranges::count(facet, vertex) > 0;
    for (const uint32_t other : facet) {
      sum += is_at * (mesh.vertices[other] - mesh.vertices[vertex]).norm();
      count += is_at && other != vertex;
    }
  }
  return count > 0 ? 3 * sum / count : 0;
}

TEST(NearestAttributesTest, AgreesWithASearchThroughAll) {
  Random random(1);
  TriangleMesh mesh = RandomSoup(30, 60, true, &random);
  // Edges of all lengths.
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] *= i % 2 == 0 ? 0.1f : 1.0f;
  }
  PointCloud points;
  for (uint32_t i = 0; i < 40; ++i) {
    points.positions.emplace_back(8 * random.Unit() - 4, 8 * random.Unit() - 4,
                                  8 * random.Unit() - 4);
    points.colors.push_back({static_cast<uint8_t>(i), 0, 0});
    points.views.AddRow(std::vector<uint32_t>{i});
  }
  const VertexAttributes attributes = NearestAttributes(mesh, points);
  size_t num_out_of_reach = 0;
  for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    std::vector<std::pair<double, uint32_t>> nearest;
    for (uint32_t i = 0; i < points.size(); ++i) {
      nearest.emplace_back((points.positions[i] - mesh.vertices[vertex]).norm(),
                           i);
    }
    std::sort(nearest.begin(), nearest.end());
    EXPECT_EQ(attributes.colors[vertex][0], nearest[0].second);
    std::vector<uint32_t> expected;
    for (int k = 0; k < 4; ++k) {
      if (nearest[k].first < Reach(mesh, vertex)) {
        expected.push_back(nearest[k].second);
      } else {
        ++num_out_of_reach;
      }
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_TRUE(std::ranges::equal(attributes.views[vertex], expected));
  }
  EXPECT_GT(num_out_of_reach, 10);
  EXPECT_LT(num_out_of_reach, 4 * mesh.vertices.size() - 10);
}

TEST(NearestAttributesTest, LeavesWhatIsFarFromAllPointsWithoutViews) {
  PointCloud points = PointsNearCube();
  points.colors.clear();
  const VertexAttributes attributes =
      NearestAttributes(Shifted(MakeCube(), {100, 0, 0}), points);
  EXPECT_EQ(attributes.views, Rows<uint32_t>(8));
  EXPECT_TRUE(attributes.colors.empty());
}

}  // namespace vertex_attributes_test
}  // namespace colmap_ext
