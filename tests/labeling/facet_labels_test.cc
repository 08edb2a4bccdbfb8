#include "labeling/facet_labels.h"

#include <gtest/gtest.h>

#include "mesh/mesh_in_image.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {
namespace facet_labels_test {

TEST(InSmallerView, ComparesEachLabelWhereTheFacetIsSmaller) {
  const RefinementScene scene = MakeRefinementScene();
  const TriangleMesh mesh = scene.Truth();
  FacetLabels labels{{{0, 1}, {0, 4}, {2, 3}}, {}, {}};
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t k = 0; k < facet % 4; ++k) {
      labels.labels.values.push_back(k);
    }
    labels.labels.EndRow();
  }
  const FacetLabels compared = InSmallerView(labels, mesh, scene.Views());
  EXPECT_EQ(compared.pairs, labels.pairs);
  EXPECT_EQ(compared.labels, labels.labels);
  size_t num_first = 0;
  size_t num_directions = 0;
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    compared.ForEachDirection(facet, [&](uint32_t direction) {
      const auto [first, second] = labels.pairs[direction / 2];
      const bool is_first = direction % 2 == 0;
      const auto area_in = [&](uint32_t view) {
        return AreaInImage(mesh, mesh.facets[facet], scene.Views()[view]);
      };
      EXPECT_LE(area_in(is_first ? first : second),
                area_in(is_first ? second : first))
          << facet;
      num_first += is_first ? 1 : 0;
      ++num_directions;
    });
  }
  EXPECT_EQ(num_directions, labels.labels.values.size());  // one each
  EXPECT_GT(num_first, 0);
  EXPECT_LT(num_first, num_directions);
}

}  // namespace facet_labels_test
}  // namespace colmap_ext
