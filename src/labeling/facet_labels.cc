#include "labeling/facet_labels.h"

#include <cstddef>
#include <cstdint>

#include <tbb/parallel_for.h>

#include "mesh/mesh_in_image.h"

namespace colmap_ext {

FacetLabels InSmallerView(FacetLabels labels, const TriangleMesh& mesh,
                          const std::vector<View>& views) {
  const Rows<uint32_t>& rows = labels.labels;
  labels.directions.resize(rows.values.size());
  tbb::parallel_for(size_t{0}, labels.NumFacets(), [&](size_t facet) {
    const auto area_in = [&](uint32_t view) {
      return AreaInImage(mesh, mesh.facets[facet], views[view]);
    };
    for (uint64_t i = rows.offsets[facet]; i < rows.offsets[facet + 1]; ++i) {
      const auto [first, second] = labels.pairs[rows.values[i]];
      labels.directions[i] =
          area_in(first) < area_in(second) ? kInFirst : kInSecond;
    }
  });
  return labels;
}

}  // namespace colmap_ext
