#include "refine/refinable_areas.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// px^2
double AreaInImage(const TriangleMesh& mesh, const Facet& facet,
                   const View& view) {
  std::array<Eigen::Vector2d, 3> corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = view.ImageFromCam(
        view.CamFromWorld(mesh.vertices[facet[k]].cast<double>()));
  }
  const Eigen::Vector2d a = corners[1] - corners[0];
  const Eigen::Vector2d b = corners[2] - corners[0];
  return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
}

}  // namespace

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
