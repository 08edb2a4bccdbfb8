// What stays stays: positions, edges and facets between fixed vertices.

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/subdivision.h"
#include "remesh/isotropic_remeshing.h"
#include "tests/mesh/manifold_links.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace fixed_vertices_test {

// What lies on one side of a plane.
FixedVertices Half(const TriangleMesh& mesh) {
  FixedVertices fixed;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    fixed.push_back(vertex.x() + 0.3F * vertex.y() > 0.1F ? 1 : 0);
  }
  return fixed;
}

Facet Turned(Facet facet) {
  std::rotate(facet.begin(), std::ranges::min_element(facet), facet.end());
  return facet;
}

// The facets all of whose corners come from fixed vertices, by these.
std::set<Facet> FixedFacets(const TriangleMesh& mesh,
                            const std::vector<uint32_t>& sources) {
  std::set<Facet> facets;
  for (const Facet& facet : mesh.facets) {
    const Facet old = {sources[facet[0]], sources[facet[1]], sources[facet[2]]};
    if (std::ranges::find(old, kNone) == old.end()) {
      facets.insert(Turned(old));
    }
  }
  return facets;
}

void ExpectFixed(const TriangleMesh& before, const FixedVertices& fixed,
                 const TriangleMesh& after,
                 const std::vector<uint32_t>& sources) {
  ASSERT_EQ(sources.size(), after.vertices.size());
  std::set<uint32_t> found;
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i] != kNone) {
      EXPECT_TRUE(IsFixed(fixed, sources[i]));
      EXPECT_EQ(before.vertices[sources[i]], after.vertices[i]);
      EXPECT_TRUE(found.insert(sources[i]).second);
    }
  }
  EXPECT_EQ(static_cast<size_t>(std::ranges::count(fixed, 1)), found.size());
  const std::set<Facet> facets = FixedFacets(after, sources);
  for (const Facet& facet : before.facets) {
    if (IsFixed(fixed, facet)) {
      EXPECT_TRUE(facets.contains(Turned(facet)));
    }
  }
}

TEST(FixedVertices, StayWhenASurfaceIsRemeshed) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.1F), MakeBumpyCap(0.1F), MakeRoundTorus(0.1F)}) {
    const FixedVertices fixed = Half(mesh);
    for (const float length : {0.05F, 0.1F, 0.3F}) {
      const std::vector<float> lengths(mesh.vertices.size(), length);
      const std::vector<float> tolerances(mesh.vertices.size(), length / 10);
      const RemeshedSurface result =
          RemeshIsotropically(mesh, lengths, tolerances, fixed);
      ExpectSameTopology(mesh, result.mesh);
      ExpectFixed(mesh, fixed, result.mesh, result.fixed_sources);
      EXPECT_NE(mesh.facets.size(), result.mesh.facets.size());
      // Long edges that stay do not make those beside them ever shorter.
      EXPECT_LT(
          result.mesh.facets.size(),
          RemeshIsotropically(mesh, lengths, tolerances).mesh.facets.size() +
              mesh.facets.size());
    }
  }
}

TEST(FixedVertices, StayWhenAnglesImprove) {
  Random random(3);
  const TriangleMesh mesh =
      Moved(MakeBumpyCap(0.1F), [&](const auto& point) -> Eigen::Vector3f {
        return point.array() + 0.06F * RandomPoint(&random).array() - 0.03F;
      });
  const FixedVertices fixed = Half(mesh);
  const RemeshedSurface improved = ImproveAngles(mesh, fixed);
  ExpectSameTopology(mesh, improved.mesh);
  ExpectFixed(mesh, fixed, improved.mesh, improved.fixed_sources);
  EXPECT_NE(mesh.facets, improved.mesh.facets);
}

TEST(FixedVertices, AreNotCutByASubdivision) {
  const TriangleMesh mesh = MakeBumpySphere(0.2F);
  const FixedVertices fixed = Half(mesh);
  const DerivedMesh result =
      Subdivide(mesh, std::vector<uint8_t>(mesh.facets.size(), 1), fixed);
  ExpectSameTopology(mesh, result.mesh);
  for (const auto& [a, b] : result.from.vertices) {
    EXPECT_TRUE(a == b || !IsFixed(fixed, a) || !IsFixed(fixed, b));
  }
  EXPECT_GT(result.mesh.facets.size(), mesh.facets.size());
}

TEST(FixedVertices, NoneLeaveTheBytesAsTheyAre) {
  const TriangleMesh mesh = MakeBumpyCap(0.1F);
  const std::vector<float> lengths(mesh.vertices.size(), 0.07F);
  const std::vector<float> tolerances(mesh.vertices.size(), 0.01F);
  const RemeshedSurface none = RemeshIsotropically(mesh, lengths, tolerances);
  const RemeshedSurface free = RemeshIsotropically(
      mesh, lengths, tolerances, FixedVertices(mesh.vertices.size(), 0));
  EXPECT_EQ(none.mesh, free.mesh);
}

}  // namespace fixed_vertices_test
}  // namespace colmap_ext
