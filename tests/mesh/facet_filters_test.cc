#include "mesh/facet_filters.h"

#include <algorithm>
#include <span>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace facet_filters_test {

// Right triangles apart from each other, with a longest side of 5, 10, 15 ...,
// the longest ones first.
TriangleMesh MakeTriangles(uint32_t num_facets) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_facets; ++i) {
    const auto scale = static_cast<float>(num_facets - i);
    const auto z = static_cast<float>(i);
    mesh.vertices.emplace_back(0.0f, 0.0f, z);
    mesh.vertices.emplace_back(3 * scale, 0.0f, z);
    mesh.vertices.emplace_back(0.0f, 4 * scale, z);
    // The longest side is any of the three.
    const Facet facet = {3 * i, 3 * i + 1, 3 * i + 2};
    mesh.facets.push_back(
        {facet[i % 3], facet[(i + 1) % 3], facet[(i + 2) % 3]});
  }
  return mesh;
}

TEST(DropLongFacets, DropsThoseAboveTheFactorTimesThePercentile) {
  const TriangleMesh all = MakeTriangles(11);  // sides 55 ... 5
  struct Case {
    double factor;
    double percentile;
    size_t num_kept;
  };
  for (const auto& [factor, percentile, num_kept] :
       {Case{1, 50, 6},      // 30 and less
        Case{1.49, 50, 8},   // 44.7
        Case{1.5, 50, 9},    // 45, itself kept
        Case{1, 100, 11},    // 55
        Case{1, 0, 1},       // 5
        Case{0.99, 0, 0},    // less than any
        Case{1, 54, 6},      // 5.4 is rounded to 5
        Case{1, 56, 7},      // 5.6 to 6
        Case{25, 95, 11},    // the default
        Case{0, 50, 11}}) {  // off
    SCOPED_TRACE(testing::Message() << factor << " " << percentile);
    TriangleMesh mesh = all;
    EXPECT_EQ(DropLongFacets(factor, percentile, &mesh), 11 - num_kept);
    EXPECT_TRUE(std::ranges::equal(
        mesh.facets, std::span(all.facets).last(num_kept)));  // the shortest
  }
  TriangleMesh nothing;
  EXPECT_EQ(DropLongFacets(1, 50, &nothing), 0);
}

TEST(DropSmallComponents, DropsThoseOfFewerFacets) {
  const TriangleMesh all =
      Union(MakeTetrahedron(),
            Union(MakeTorus(), Union(MakeTetrahedron(), MakeCube())));
  struct Case {
    size_t min_facets;
    DroppedComponents dropped;
  };
  for (const auto& [min_facets, expected] :
       {Case{0, {0, 0}}, Case{1, {0, 0}}, Case{4, {0, 0}}, Case{5, {2, 8}},
        Case{12, {2, 8}}, Case{13, {3, 20}}, Case{70, {3, 20}},
        Case{71, {4, 90}}}) {
    SCOPED_TRACE(min_facets);
    TriangleMesh mesh = all;
    const DroppedComponents dropped =
        DropSmallComponents(min_facets, &mesh.facets);
    EXPECT_EQ(dropped.num_components, expected.num_components);
    EXPECT_EQ(dropped.num_facets, expected.num_facets);
    EXPECT_EQ(mesh.facets.size() + dropped.num_facets, all.facets.size());
  }
  TriangleMesh mesh = all;
  DropSmallComponents(20, &mesh.facets);
  EXPECT_EQ(mesh.facets, std::vector<Facet>(all.facets.begin() + 4,
                                            all.facets.begin() + 74));
}

TEST(DropSmallComponents, VerticesDoNotConnect) {
  TriangleMesh mesh = Union(MakeCube(), MakeTetrahedron());
  MergeVertices(8, 7, &mesh);
  const DroppedComponents dropped = DropSmallComponents(5, &mesh.facets);
  EXPECT_EQ(dropped.num_components, 1u);
  EXPECT_EQ(mesh.facets.size(), 12u);
}

}  // namespace facet_filters_test
}  // namespace colmap_ext
