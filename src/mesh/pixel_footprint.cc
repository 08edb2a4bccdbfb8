#include "mesh/pixel_footprint.h"

#include <cmath>

#include "base/percentile.h"

namespace colmap_ext {

double MedianFootprint(const TriangleMesh& mesh,
                       const Rows<uint32_t>& vertex_views,
                       const std::vector<View>& views) {
  std::vector<double> footprints;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const uint32_t view_index : vertex_views[i]) {
      const View& view = views[view_index];
      const double depth =
          view.CamFromWorld(mesh.vertices[i].cast<double>()).z();
      if (depth > 0) {
        footprints.push_back(depth / std::sqrt(view.fx * view.fy));
      }
    }
  }
  return footprints.empty() ? 0 : Median(&footprints);
}

}  // namespace colmap_ext
