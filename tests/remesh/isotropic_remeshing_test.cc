#include "remesh/isotropic_remeshing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/remesh/remeshed.h"
#include "tests/threads.h"

namespace colmap_ext::isotropic_remeshing_test {

// One facet whose corners differ in everything.
struct OneFacet {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  VertexAttributes attributes{{{0, 0, 0}, {100, 0, 0}, {0, 200, 7}},
                              Rows<uint32_t>({0, 2, 3, 5}, {1, 4, 2, 1, 9}),
                              {0, 0.5F, 1}};
};

TEST(CarryAttributes, AreOfTheCornersThatHaveAPart) {
  const OneFacet one;
  const VertexAttributes carried =
      CarryAttributes(one.mesh, one.attributes,
                      {{0, {1, 0, 0}}, {0, {0, 1, 0}}, {0, {0, 0, 1}}});
  EXPECT_EQ(carried.colors, one.attributes.colors);
  EXPECT_EQ(carried.confidences, one.attributes.confidences);
  EXPECT_EQ(carried.views, one.attributes.views);
  const VertexAttributes between = CarryAttributes(
      one.mesh, one.attributes, {{0, {0, 0.25F, 0.75F}}, {0, {0.5F, 0.5F, 0}}});
  EXPECT_EQ(between.colors[0], (Color{25, 150, 5}));
  EXPECT_FLOAT_EQ(between.confidences[0], 0.875F);
  EXPECT_TRUE(
      std::ranges::equal(between.views[0], std::vector<uint32_t>{1, 2, 9}));
  EXPECT_TRUE(
      std::ranges::equal(between.views[1], std::vector<uint32_t>{1, 2, 4}));
  const VertexAttributes without =
      CarryAttributes(one.mesh, {{}, one.attributes.views}, {{0, {1, 0, 0}}});
  EXPECT_TRUE(without.colors.empty() && without.confidences.empty());
}

TEST(RemeshEvenly, KeepsTheNumberOfFacetsAndCarriesAttributes) {
  const TriangleMesh before = MakeBumpyCap(0.1F);
  Surface surface{before, {}};
  for (const Eigen::Vector3f& vertex : before.vertices) {
    surface.attributes.confidences.push_back((vertex.x() + 2) / 4);
    surface.attributes.views.AddRow(std::vector<uint32_t>{3});
  }
  RemeshEvenly(&surface);
  const auto& [mesh, attributes, origins, fixed] = surface;
  ExpectSameTopology(before, mesh);
  EXPECT_NEAR(static_cast<double>(mesh.facets.size()) / before.facets.size(), 1,
              0.4);
  ASSERT_EQ(attributes.confidences.size(), mesh.vertices.size());
  ASSERT_EQ(attributes.views.size(), mesh.vertices.size());
  EXPECT_TRUE(origins.empty() && fixed.empty());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(attributes.confidences[i], (mesh.vertices[i].x() + 2) / 4,
                0.01);
    EXPECT_EQ(attributes.views[i].size(), 1);
  }
}

double Percentile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<size_t>(share * (values.size() - 1))];
}

// The largest distance of the corners, middles of edges and centres of one
// mesh's facets from another.
double Distance(const TriangleMesh& mesh, const TriangleMesh& other) {
  const Bvh bvh(other);
  double distance = 0;
  for (const Facet& facet : mesh.facets) {
    const auto [a, b, c] = CornersOf(mesh, facet);
    for (const Eigen::Vector3f& point :
         {a, Eigen::Vector3f((a + b) / 2), Eigen::Vector3f((a + b + c) / 3)}) {
      distance = std::max(distance, bvh.Distance(point, 1e3));
    }
  }
  return distance;
}

std::vector<float> Everywhere(const TriangleMesh& mesh, float value) {
  return std::vector<float>(mesh.vertices.size(), value);
}

// The topology stays in every case.
RemeshedSurface Remesh(const TriangleMesh& mesh, float length,
                       float tolerance) {
  RemeshedSurface result = RemeshIsotropically(
      mesh, Everywhere(mesh, length), Everywhere(mesh, tolerance * length));
  ExpectSameTopology(mesh, result.mesh);
  return result;
}

TEST(RemeshIsotropically, ShapesFacetsAndKeepsTheSurface) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.1F), MakeBumpyCap(0.1F), MakeRoundTorus(0.1F)}) {
    for (const float length : {0.07F, 0.1F, 0.16F}) {
      const RemeshedSurface result = Remesh(mesh, length, 0.1F);
      const std::vector<double> angles = SmallestAngles(result.mesh);
      EXPECT_GT(Percentile(angles, 0.5), 42) << length;
      EXPECT_GT(Percentile(angles, 0.02), 20) << length;
      EXPECT_LT(Distance(result.mesh, mesh), 0.2 * length);
      EXPECT_LT(Distance(mesh, result.mesh), 0.3 * length);
      // Facets of the size that is wanted.
      const double wanted = Area(mesh) / (std::sqrt(3.0) / 4 * length * length);
      EXPECT_NEAR(result.mesh.facets.size() / wanted, 1, 0.35) << length;
    }
  }
}

TEST(RemeshIsotropically, SourcesAreWhereTheVerticesAre) {
  const TriangleMesh mesh = MakeBumpyCap(0.1F);
  const RemeshedSurface result = Remesh(mesh, 0.07F, 0.1F);
  ASSERT_EQ(result.sources.size(), result.mesh.vertices.size());
  for (size_t i = 0; i < result.sources.size(); ++i) {
    const SurfacePoint& source = result.sources[i];
    ASSERT_LT(source.facet, mesh.facets.size());
    EXPECT_NEAR(source.weights.sum(), 1, 1e-5);
    EXPECT_GE(source.weights.minCoeff(), 0);
    EXPECT_LT(
        (ValueAt(source, mesh, mesh.vertices) - result.mesh.vertices[i]).norm(),
        0.01F);
  }
}

// The edges and corners of a cube stay where they are, up to the tolerance.
TEST(RemeshIsotropically, CreasesSurvive) {
  const TriangleMesh cube = MakeFineCube(0.15F);
  const float length = 0.2F;
  const RemeshedSurface result = Remesh(cube, length, 0.1F);
  EXPECT_LT(Distance(result.mesh, cube), 0.1 * length + 1e-4);
  EXPECT_LT(Distance(cube, result.mesh), 0.2 * length);
  EXPECT_NEAR(Area(result.mesh), Area(cube), 0.02 * Area(cube));
}

TEST(RemeshIsotropically, BordersStay) {
  Random random(3);
  const TriangleMesh square = MakeJitteredSquare(20, &random);
  const RemeshedSurface result = Remesh(square, 0.08F, 0.1F);
  EXPECT_NEAR(Area(result.mesh), 1, 1e-4);
  EXPECT_LT(Distance(square, result.mesh), 1e-4);
}

// What a mesh should not be: needles, and facets without an area.
TEST(RemeshIsotropically, NeedlesAndCapsBecomeFacets) {
  // Rows close together, columns far apart.
  const TriangleMesh needles = Moved(MakeSheet(40, 4), [](const auto& p) {
    return Eigen::Vector3f(0.02F * p.y(), 0.25F * p.x(), 0);
  });
  const RemeshedSurface result = Remesh(needles, 0.06F, 0.1F);
  EXPECT_GT(Percentile(SmallestAngles(result.mesh), 0.02), 20);
  EXPECT_NEAR(Area(result.mesh), Area(needles), 1e-4);

  // Pull inner vertices onto their neighbors, and onto the edge across.
  Random random(4);
  TriangleMesh caps = MakeJitteredSquare(20, &random);
  for (uint32_t i = 23; i < caps.vertices.size() - 23; i += 3) {
    if (i % 21 != 0 && i % 21 != 20) {
      caps.vertices[i] = caps.vertices[i + 1];
    }
  }
  const RemeshedSurface repaired = Remesh(caps, 0.07F, 0.1F);
  EXPECT_GT(Percentile(SmallestAngles(repaired.mesh), 0.05), 10);
}

// Facets grow with the lengths that are wanted.
TEST(RemeshIsotropically, FollowsTheLengths) {
  Random random(5);
  const TriangleMesh square = MakeJitteredSquare(40, &random);
  std::vector<float> lengths(square.vertices.size());
  for (size_t i = 0; i < lengths.size(); ++i) {
    lengths[i] = 0.02F + 0.1F * square.vertices[i].x();
  }
  const RemeshedSurface result = RemeshIsotropically(
      square, lengths, std::vector<float>(lengths.size(), 0.01F));
  ExpectSameTopology(square, result.mesh);
  std::vector<double> ratios;
  for (const auto& [a, b, c] : result.mesh.facets) {
    const Eigen::Vector3f& from = result.mesh.vertices[a];
    const Eigen::Vector3f& to = result.mesh.vertices[b];
    ratios.push_back((to - from).norm() / (0.02 + 0.05 * (from + to).x()));
  }
  EXPECT_NEAR(Percentile(ratios, 0.5), 1, 0.15);
  EXPECT_GT(Percentile(ratios, 0.05), 0.6);
  EXPECT_LT(Percentile(ratios, 0.95), 1.5);
}

TEST(RemeshIsotropically, AnyManifoldMeshStaysOne) {
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    Remesh(MakeRandomManifold(&random), 0.3F, 0.1F);
  }
}

TEST(RemeshIsotropically, TheSameWithAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  ExpectSameForAnyThreads([&] { return Remesh(mesh, 0.06F, 0.1F).mesh; });
}

constexpr float kLength = 0.1F;

// Of well-shaped facets.
TriangleMesh MakeEven(const TriangleMesh& mesh) {
  return Remesh(mesh, kLength, 0.1F).mesh;
}

std::vector<TriangleMesh> ThinMeshes() {
  Random random(2);
  return {MakeThinFacets(MakeEven(MakeBumpySphere(0.1F)), &random),
          MakeThinFacets(MakeEven(MakeBumpyCap(0.1F)), &random),
          MakeThinFacets(MakeEven(MakeRoundTorus(0.1F)), &random)};
}

// Facets that are well shaped keep their corners, unless a neighbor is not.
TEST(ImproveAngles, ThinFacetsGoAndTheRestStaysAsItIs) {
  for (const TriangleMesh& thin : ThinMeshes()) {
    ASSERT_GT(ShareBelow(10, thin), 0.01);
    const auto [mesh, sources, fixed, facet_sources] = ImproveAngles(thin);
    ExpectSameTopology(thin, mesh);
    EXPECT_LT(ShareBelow(10, mesh), 0.1 * ShareBelow(10, thin));
    EXPECT_LT(Distance(mesh, thin), 0.25 * kLength);
    EXPECT_LT(Distance(thin, mesh), 0.25 * kLength);
    ASSERT_EQ(facet_sources.size(), mesh.facets.size());
    size_t num_kept = 0;
    for (size_t i = 0; i < mesh.facets.size(); ++i) {
      num_kept += CornersOf(mesh, mesh.facets[i]) ==
                  CornersOf(thin, thin.facets[facet_sources[i]]);
    }
    EXPECT_GT(num_kept, mesh.facets.size() * 2 / 3);
    ASSERT_EQ(sources.size(), mesh.vertices.size());
    const std::vector<Eigen::Vector3f> positions =
        ValuesAt(sources, thin, thin.vertices);
    for (size_t i = 0; i < positions.size(); ++i) {
      EXPECT_LT((positions[i] - mesh.vertices[i]).norm(), 1e-5F);
    }
  }
}

TEST(ImproveAngles, AMeshWithoutThinFacetsIsLeftAlone) {
  const TriangleMesh mesh = Moved(MakeSheet(10, 10), [](const auto& p) {
    return Eigen::Vector3f(p.x() - 0.5F * p.y(), 0.866F * p.y(),
                           0.1F * (10 - p.x()) * p.y());
  });
  EXPECT_EQ(ImproveAngles(mesh).mesh, mesh);
}

TEST(ImproveAngles, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh thin = ThinMeshes()[0];
  ExpectSameForAnyThreads([&] {
    const RemeshedSurface improved = ImproveAngles(thin);
    return std::pair(improved.mesh, improved.facet_sources);
  });
}

// On a sphere the facets' middles stray by the tolerance.
TEST(LengthsForCurvature, KeepToTheToleranceOnASphere) {
  const TriangleMesh sphere = MakeBumpySphere(0.04F, 0);
  for (const float tolerance : {0.002F, 0.008F}) {
    std::vector<float> lengths =
        LengthsForCurvature(sphere, Everywhere(sphere, tolerance));
    const float exact = std::sqrt(6 * tolerance - 3 * tolerance * tolerance);
    for (const float length : lengths) {
      EXPECT_NEAR(length / exact, 1, 0.25);
    }
    LimitGradation(sphere, kGradation, &lengths);
    const TriangleMesh remeshed =
        RemeshIsotropically(sphere, lengths, TolerancesOf(lengths)).mesh;
    EXPECT_LT(remeshed.facets.size(), sphere.facets.size());
    EXPECT_LT(Distance(remeshed, sphere), 1.8 * tolerance);
    EXPECT_GT(Distance(remeshed, sphere), 0.8 * tolerance);
  }
}

TEST(LengthsForCurvature, GrowWithTheSceneAndAreInfiniteWhereUnbounded) {
  const TriangleMesh sheet = MakeSheet(5, 5);
  EXPECT_EQ(LengthsForCurvature(sheet, Everywhere(sheet, 0.01F)),
            Everywhere(sheet, INFINITY));
  const TriangleMesh sphere = MakeBumpySphere(0.2F);
  EXPECT_EQ(LengthsForCurvature(sphere, Everywhere(sphere, INFINITY)),
            Everywhere(sphere, INFINITY));
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  const std::vector<float> lengths =
      LengthsForCurvature(mesh, Everywhere(mesh, 0.01F));
  const std::vector<float> larger =
      LengthsForCurvature(Moved(mesh, [](const auto& p) { return 4 * p; }),
                          Everywhere(mesh, 0.04F));
  for (size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(larger[i], 4 * lengths[i], 1e-4F * larger[i]);
  }
}

TEST(LimitGradation, GrowsNoFasterThanAllowed) {
  Random random(7);
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  std::vector<float> lengths(mesh.vertices.size());
  for (float& length : lengths) {
    length = static_cast<float>(random.Unit());
  }
  const std::vector<float> before = lengths;
  LimitGradation(mesh, 0.3F, &lengths);
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = facet[k];
      const uint32_t b = facet[(k + 1) % 3];
      EXPECT_LE(lengths[a],
                lengths[b] +
                    0.3F * (mesh.vertices[a] - mesh.vertices[b]).norm() +
                    1e-5F);
    }
  }
  for (size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_LE(lengths[i], before[i]);
  }
  // As large as that allows: a second time changes nothing.
  std::vector<float> again = lengths;
  LimitGradation(mesh, 0.3F, &again);
  EXPECT_EQ(again, lengths);
}

TEST(MeanEdgeLengths, AreThoseOfARegularMesh) {
  TriangleMesh mesh = MakeTetrahedron();
  const float edge = (mesh.vertices[0] - mesh.vertices[1]).norm();
  for (const float length : MeanEdgeLengths(mesh)) {
    EXPECT_NEAR(length, edge, 0.5F * edge);
  }
}

}  // namespace colmap_ext::isotropic_remeshing_test
