#include "refine/adaptive_subdivision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/subdivision.h"

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

// [F] 1 where the second largest area is above max_area, else 0.
std::vector<uint8_t> FindLarge(double max_area, const TriangleMesh& mesh,
                               const std::vector<View>& views,
                               const FacetVisibility& visibility) {
  std::vector<uint8_t> is_large(mesh.facets.size(), 0);
  tbb::parallel_for(size_t{0}, is_large.size(), [&](size_t i) {
    double largest = 0;
    double second = 0;
    for (const uint32_t view : visibility[i]) {
      const double area = AreaInImage(mesh, mesh.facets[i], views[view]);
      second = std::max(second, std::min(area, largest));
      largest = std::max(area, largest);
    }
    is_large[i] = second > max_area;
  });
  return is_large;
}

}  // namespace

FacetVisibility SubdivideLargeFacets(double max_area, const DrawMesh& draw,
                                     TriangleMesh* mesh,
                                     VertexAttributes* attributes,
                                     std::vector<Eigen::Vector3f>* origins) {
  // A round cuts a facet in four: 4^8 parts are enough for one that is 65536
  // times too large.
  constexpr int kMaxRounds = 8;
  for (int round = 0;; ++round) {
    const std::shared_ptr<const MeshDrawings> drawings = draw(*mesh);
    FacetVisibility visibility = FindVisibleFacets(*drawings);
    if (round == kMaxRounds) {
      return visibility;
    }
    const std::vector<uint8_t> is_large =
        FindLarge(max_area, *mesh, drawings->Views(), visibility);
    if (std::count(is_large.begin(), is_large.end(), 1) == 0) {
      return visibility;
    }
    Subdivision subdivision = Subdivide(*mesh, is_large);
    *attributes = InterpolateAttributes(*attributes, subdivision.sources);
    *origins = Midpoints(*origins, subdivision.sources);
    *mesh = std::move(subdivision.mesh);
  }
}

}  // namespace colmap_ext
