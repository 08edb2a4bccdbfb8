#include "refine/adaptive_subdivision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/subdivision.h"
#include "raster/facet_visibility.h"

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

std::vector<Eigen::Vector3f> Midpoints(
    const std::vector<Eigen::Vector3f>& points,
    const std::vector<std::array<uint32_t, 2>>& sources) {
  std::vector<Eigen::Vector3f> midpoints;
  midpoints.reserve(sources.size());
  for (const auto& [a, b] : sources) {
    midpoints.emplace_back((points[a] + points[b]) / 2);
  }
  return midpoints;
}

}  // namespace

void SubdivideLargeFacets(double max_area, double min_cosine,
                          const std::vector<View>& views, TriangleMesh* mesh,
                          VertexAttributes* attributes,
                          std::vector<Eigen::Vector3f>* origins) {
  constexpr int kMaxRounds = 8;
  FacetVisibilityOptions options;
  options.min_cosine = min_cosine;
  for (int round = 0; round < kMaxRounds; ++round) {
    const FacetVisibility visibility = FindVisibleFacets(options, *mesh, views);
    std::vector<uint8_t> is_large(mesh->facets.size(), 0);
    tbb::parallel_for(size_t{0}, is_large.size(), [&](size_t i) {
      double largest = 0;
      double second = 0;
      for (const uint32_t view : visibility[i]) {
        const double area = AreaInImage(*mesh, mesh->facets[i], views[view]);
        second = std::max(second, std::min(area, largest));
        largest = std::max(area, largest);
      }
      is_large[i] = second > max_area;
    });
    if (std::count(is_large.begin(), is_large.end(), 1) == 0) {
      return;
    }
    Subdivision subdivision = Subdivide(*mesh, is_large);
    *attributes = InterpolateAttributes(*attributes, subdivision.sources);
    *origins = Midpoints(*origins, subdivision.sources);
    *mesh = std::move(subdivision.mesh);
  }
}

}  // namespace colmap_ext
