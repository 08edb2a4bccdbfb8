#include "mesh/surface.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "mesh/confidences.h"
#include "mesh/normals.h"
#include "scene/view.h"
#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/random_vectors.h"
#include "tests/threads.h"

namespace colmap_ext::vertex_attributes_test {

using Eigen::Vector3f;

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
    const uint32_t a = random.Below(kNumVertices);
    sources.push_back({a, i % 4 == 0 ? a : random.Below(kNumVertices)});
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

// Point i is seen by views i and i + 1.
PointCloud RandomPoints(Random* random) {
  PointCloud points;
  for (uint32_t i = 0; i < 40; ++i) {
    points.positions.push_back(RandomVector(random, 4).cast<float>());
    points.colors.push_back({static_cast<uint8_t>(i), 0, 255});
    points.views.AddRow(std::vector<uint32_t>{i, i + 1});
  }
  return points;
}

// Three mean lengths of a vertex's edges; 0 without edges.
double Reach(const TriangleMesh& mesh, uint32_t vertex) {
  std::set<uint32_t> others;
  for (const Facet& facet : mesh.facets) {
    if (std::ranges::count(facet, vertex) > 0) {
      others.insert(facet.begin(), facet.end());
    }
  }
  others.erase(vertex);
  double sum = 0;
  for (const uint32_t other : others) {
    sum += (mesh.vertices[other] - mesh.vertices[vertex]).norm();
  }
  return others.empty() ? 0 : 3 * sum / static_cast<double>(others.size());
}

TEST(NearestAttributesTest, AgreesWithASearchThroughAll) {
  Random random(1);
  TriangleMesh mesh = RandomSoup(30, 60, true, &random);
  // Edges of all lengths.
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] *= i % 2 == 0 ? 0.1f : 1.0f;
  }
  const PointCloud points = RandomPoints(&random);
  const VertexAttributes attributes = NearestAttributes(mesh, points);
  size_t num_out_of_reach = 0;
  for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    std::vector<std::pair<double, uint32_t>> nearest;
    for (uint32_t i = 0; i < points.size(); ++i) {
      nearest.emplace_back((points.positions[i] - mesh.vertices[vertex]).norm(),
                           i);
    }
    std::ranges::sort(nearest);
    EXPECT_EQ(attributes.colors[vertex], points.colors[nearest[0].second]);
    std::set<uint32_t> expected;
    for (int k = 0; k < 4; ++k) {
      if (nearest[k].first < Reach(mesh, vertex)) {
        expected.insert({nearest[k].second, nearest[k].second + 1});
      } else {
        ++num_out_of_reach;
      }
    }
    EXPECT_TRUE(std::ranges::equal(attributes.views[vertex], expected));
  }
  EXPECT_GT(num_out_of_reach, 10);
  EXPECT_LT(num_out_of_reach, 4 * mesh.vertices.size() - 10);
}

TEST(NearestAttributesTest, LeavesWhatIsFarFromAllPointsWithoutViews) {
  Random random(1);
  PointCloud points = RandomPoints(&random);
  points.colors.clear();
  const VertexAttributes attributes =
      NearestAttributes(Shifted(MakeCube(), {100, 0, 0}), points);
  EXPECT_EQ(attributes.views, Rows<uint32_t>(8));
  EXPECT_TRUE(attributes.colors.empty());
}

// A square grid of unit facets that three views look down on.
struct FacetConfidencesTest : testing::Test {
  FacetConfidencesTest() {
    for (size_t i = 0; i < mesh_.vertices.size(); ++i) {
      AddSupport();
    }
    for (const double x : {0.0, 5.0, 10.0}) {
      views_.push_back(LookAtView({x, 0, 30}, {6, 6, 0},
                                  Eigen::Vector3d::UnitY(), 1000, 1000, 1000));
    }
  }

  void AddSupport() {
    vertex_views_.AddRow(std::vector<uint32_t>{0, 1, 2});
    support_.push_back(5);
  }

  // A facet from the corner of the grid to two new vertices far away, each with
  // as much support as the others.
  void AddMembrane() {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    mesh_.vertices.emplace_back(-20.0f, 0.0f, -1.0f);
    mesh_.vertices.emplace_back(0.0f, -20.0f, -1.0f);
    mesh_.facets.push_back({0, first, first + 1});
    AddSupport();
    AddSupport();
  }

  std::vector<float> Confidences() const {
    return FacetConfidences(mesh_, support_, vertex_views_, views_);
  }

  TriangleMesh mesh_ = MakeSheet(11, 11);
  std::vector<float> support_;
  Rows<uint32_t> vertex_views_;
  std::vector<View> views_;
};

// As far as `a` goes.
void ExpectNear(const std::vector<float>& a, const std::vector<float>& b,
                double tolerance = 1e-5) {
  ASSERT_LE(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], tolerance) << i;
  }
}

TEST_F(FacetConfidencesTest,
       IsSureOfWhatIsSeenAndNotOfAMembraneWithAnyThreads) {
  AddMembrane();
  std::vector<float> confidences = Confidences();
  EXPECT_LT(confidences.back(), 0.05);
  confidences.pop_back();
  for (const float confidence : confidences) {
    EXPECT_GT(confidence, 0.85);
    EXPECT_LE(confidence, 1);
  }
  ExpectSameForAnyThreads([&] { return Confidences(); });
}

TEST_F(FacetConfidencesTest, AMembraneDoesNotChangeTheFacetsBesideIt) {
  const std::vector<float> before = Confidences();
  AddMembrane();
  ExpectNear(before, Confidences(), 0.02);
}

TEST_F(FacetConfidencesTest, DependsOnNoScale) {
  Random random(1);
  for (float& support : support_) {
    support = static_cast<float>(1 + 10 * random.Unit());
  }
  const std::vector<float> confidences = Confidences();
  mesh_ = Scaled(mesh_, 4);
  views_ = Scaled(views_, 4);
  ExpectNear(Confidences(), confidences);
  for (View& view : views_) {
    view = ResizeView(view, 500, 500);
  }
  ExpectNear(Confidences(), confidences);
  std::ranges::for_each(support_, [](float& support) { support *= 0.125f; });
  ExpectNear(Confidences(), confidences);
}

TEST_F(FacetConfidencesTest, LessSupportIsLessConfidenceAndNoneIsUnknown) {
  const float before = Confidences()[0];
  for (const uint32_t vertex : mesh_.facets[0]) {
    support_[vertex] /= 4;
  }
  EXPECT_LT(Confidences()[0], before);
  for (const uint32_t vertex : mesh_.facets[0]) {
    support_[vertex] = 0;
  }
  EXPECT_EQ(Confidences()[0], 0);
  EXPECT_GT(Confidences().back(), 0.5);
  std::ranges::fill(support_, 0.0f);
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.facets.size(), 0));
  std::ranges::fill(support_, 1.0f);
  vertex_views_ = Rows<uint32_t>(mesh_.vertices.size());
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.facets.size(), 0));
}

TEST(VertexConfidences, WeighsFacetsByTheirAnglesAndHasNoneWithoutAny) {
  // A right angle and half of one at vertex 0.
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}},
                             {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<float> confidences = VertexConfidences(mesh, {0.9f, 0.3f});
  EXPECT_NEAR(confidences[0], (2 * 0.9 + 0.3) / 3, 1e-6);
  EXPECT_NEAR(confidences[1], 0.9, 1e-6);
  EXPECT_NEAR(confidences[3], 0.3, 1e-6);
  EXPECT_EQ(VertexConfidences({{{0, 0, 0}}, {}}, {}), std::vector<float>{0});
}

TEST(VertexConfidences, StayWithinThoseOfTheFacets) {
  Random random(1);
  const TriangleMesh mesh = MakeCube();
  std::vector<float> facets;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    facets.push_back(static_cast<float>(random.Unit()));
  }
  for (const float confidence : VertexConfidences(mesh, facets)) {
    EXPECT_GE(confidence, std::ranges::min(facets));
    EXPECT_LE(confidence, std::ranges::max(facets));
  }
  const std::vector<float> ones(facets.size(), 1);
  EXPECT_EQ(VertexConfidences(mesh, ones),
            std::vector<float>(mesh.vertices.size(), 1));
}

TEST(MeanOfCorners, IsThat) {
  EXPECT_EQ(MeanOfCorners({{0, 1, 2}, {2, 2, 1}}, {0, 0.5f, 1}),
            (std::vector<float>{0.5f, 2.5f / 3}));
}

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh) {
  return VertexNormals(mesh, MakeVertexRings(mesh));
}

TEST(Normals, OfASpherePointOutwards) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const std::vector<Vector3f> of_facets = FacetNormals(mesh);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_NEAR(of_facets[i].norm(), 1, 1e-6);
    EXPECT_GT(of_facets[i].dot(mesh.vertices[mesh.facets[i][0]]), 0.9f);
  }
  const std::vector<Vector3f> of_vertices = VertexNormals(mesh);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(of_vertices[i].norm(), 1, 1e-6);
    EXPECT_GT(of_vertices[i].dot(mesh.vertices[i].normalized()), 0.99f);
  }
}

TEST(Normals, AreZeroWhereThereIsNone) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}},
                             {{0, 1, 2}}};
  EXPECT_EQ(FacetNormals(line).front(), Vector3f::Zero());
  EXPECT_EQ(VertexNormals(line), std::vector<Vector3f>(4, Vector3f(0, 0, 0)));
  EXPECT_TRUE(FacetNormals(TriangleMesh()).empty());
  EXPECT_TRUE(VertexNormals(TriangleMesh()).empty());
}

TEST(FacetNormals, OfTinyFacetsAreUnit) {
  const TriangleMesh mesh = Scaled(MakeTetrahedron(), 1e-20f);
  EXPECT_EQ(FacetNormals(mesh), FacetNormals(MakeTetrahedron()));
}

// Weighted by angles they do not depend on how the sides are cut in facets.
TEST(VertexNormals, OfACubesCornersPointAlongItsDiagonals) {
  const TriangleMesh cube = MakeCube();
  const std::vector<Vector3f> normals = VertexNormals(cube);
  for (size_t i = 0; i < cube.vertices.size(); ++i) {
    const Vector3f diagonal =
        (cube.vertices[i] - Vector3f::Constant(0.5f)).normalized();
    EXPECT_LT((normals[i] - diagonal).norm(), 1e-6);
  }
}

TEST(Normals, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  ExpectSameForAnyThreads(
      [&] { return std::pair(FacetNormals(mesh), VertexNormals(mesh)); });
}

}  // namespace colmap_ext::vertex_attributes_test
