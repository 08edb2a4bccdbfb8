#include "refine/refinable_areas.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "mesh/area_in_image.h"

namespace colmap_ext {

std::vector<float> RefinableAreas(const TriangleMesh& mesh,
                                  const std::vector<View>& views,
                                  const FacetVisibility& visibility) {
  std::vector<float> areas(mesh.facets.size(), 0);
  tbb::parallel_for(size_t{0}, areas.size(), [&](size_t i) {
    double largest = 0;
    double second = 0;
    for (const uint32_t view : visibility[i]) {
      const double area = AreaInImage(mesh, mesh.facets[i], views[view]);
      second = std::max(second, std::min(area, largest));
      largest = std::max(area, largest);
    }
    areas[i] = static_cast<float>(second);
  });
  return areas;
}

}  // namespace colmap_ext
