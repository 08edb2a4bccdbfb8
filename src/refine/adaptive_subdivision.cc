#include "refine/adaptive_subdivision.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "mesh/subdivision.h"
#include "refine/refinable_areas.h"

namespace colmap_ext {

namespace {

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

// [F] 1 where a facet covers more than max_area, else 0.
std::vector<uint8_t> FindLarge(double max_area, const TriangleMesh& mesh,
                               const std::vector<View>& views,
                               const FacetVisibility& visibility) {
  const std::vector<float> areas = RefinableAreas(mesh, views, visibility);
  std::vector<uint8_t> is_large(areas.size(), 0);
  std::transform(areas.begin(), areas.end(), is_large.begin(),
                 [&](float area) { return area > max_area; });
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
