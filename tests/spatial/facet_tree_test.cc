#include "spatial/facet_tree.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace facet_tree_test {

FacetTree::Box BoxOf(const TriangleMesh& mesh, const Facet& facet) {
  FacetTree::Box box;
  for (const uint32_t vertex : facet) {
    box.extend(mesh.vertices[vertex]);
  }
  return box;
}

TEST(FacetTree, FindsAllPairsOfBoxesThatMeetOnce) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeDisc(), MakeBumpySphere(0.2f),
        RandomSoup(300, 100, true, &random)}) {
    std::set<std::pair<uint32_t, uint32_t>> expected;
    for (uint32_t a = 0; a < mesh.facets.size(); ++a) {
      for (uint32_t b = a + 1; b < mesh.facets.size(); ++b) {
        if (BoxOf(mesh, mesh.facets[a])
                .intersects(BoxOf(mesh, mesh.facets[b]))) {
          expected.emplace(a, b);
        }
      }
    }
    const FacetTree tree(mesh);
    std::set<std::pair<uint32_t, uint32_t>> found;
    for (size_t leaf = 0; leaf < tree.NumLeaves(); ++leaf) {
      tree.ForEachPair(leaf, [&](uint32_t a, uint32_t b) {
        EXPECT_TRUE(found.insert(std::minmax(a, b)).second);
      });
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace facet_tree_test
}  // namespace colmap_ext
