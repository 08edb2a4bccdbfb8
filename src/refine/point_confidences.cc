#include "refine/point_confidences.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include "mesh/facet_confidences.h"
#include "mesh/vertex_confidences.h"
#include "spatial/bvh.h"

namespace colmap_ext {
namespace {

// From where a point is seen.
struct Sight {
  Eigen::Vector3d direction{0, 0, 0};  // to the views, of any length
  double footprint =
      std::numeric_limits<double>::infinity();  // the smallest width of a
                                                // pixel there, scene units
};

Sight SightOf(const PointCloud& points, const std::vector<View>& views,
              size_t point) {
  Sight sight;
  const Eigen::Vector3d position = points.positions[point].cast<double>();
  for (const uint32_t index : points.views[point]) {
    const View& view = views[index];
    const double depth = view.CamFromWorld(position).z();
    if (depth > 0) {
      sight.direction += (view.Center() - position).normalized();
      sight.footprint =
          std::min(sight.footprint, depth / std::max(view.fx, view.fy));
    }
  }
  return sight;
}

// [P] the facet that each point supports, or kNone.
std::vector<uint32_t> SupportedFacets(const TriangleMesh& mesh,
                                      const PointCloud& points,
                                      const std::vector<View>& views) {
  // As far as the refinement may have moved the surface: a choice.
  constexpr double kMaxPixels = 4;
  const Bvh bvh(mesh);
  std::vector<uint32_t> facets(points.size(), kNone);
  tbb::parallel_for(size_t{0}, facets.size(), [&](size_t i) {
    const Sight sight = SightOf(points, views, i);
    if (sight.footprint < std::numeric_limits<double>::infinity()) {
      facets[i] =
          bvh.NearestFacet(points.positions[i], sight.direction.cast<float>(),
                           kMaxPixels * sight.footprint);
    }
  });
  return facets;
}

}  // namespace

std::vector<float> PointConfidences(const TriangleMesh& mesh,
                                    const Rows<uint32_t>& vertex_views,
                                    const PointCloud& points,
                                    const std::vector<View>& views) {
  std::vector<float> support(mesh.vertices.size(), 0);
  for (const uint32_t facet : SupportedFacets(mesh, points, views)) {
    if (facet != kNone) {
      for (const uint32_t vertex : mesh.facets[facet]) {
        support[vertex] += 1.0F / 3;
      }
    }
  }
  return VertexConfidences(
      mesh, FacetConfidences(mesh, support, vertex_views, views));
}

}  // namespace colmap_ext
