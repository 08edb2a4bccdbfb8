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

// Whether an edge of a facet stays.
bool HasFixedEdge(const FixedVertices& fixed, const Facet& facet) {
  return IsFixed(fixed, facet[0]) + IsFixed(fixed, facet[1]) +
             IsFixed(fixed, facet[2]) >
         1;
}

// [F] 1 where a facet covers more than max_area, else 0.
std::vector<uint8_t> FindLarge(double max_area, const TriangleMesh& mesh,
                               const std::vector<View>& views,
                               const FacetVisibility& visibility,
                               const FixedVertices& fixed) {
  const std::vector<float> areas = RefinableAreas(mesh, views, visibility);
  std::vector<uint8_t> is_large(areas.size(), 0);
  for (size_t i = 0; i < areas.size(); ++i) {
    is_large[i] = areas[i] > max_area && !HasFixedEdge(fixed, mesh.facets[i]);
  }
  return is_large;
}

}  // namespace

FacetVisibility SubdivideLargeFacets(double max_area, const DrawMesh& draw,
                                     TriangleMesh* mesh,
                                     VertexAttributes* attributes,
                                     std::vector<Eigen::Vector3f>* origins,
                                     FixedSources* fixed_sources) {
  // A round cuts a facet in four: 4^8 parts are enough for one that is 65536
  // times too large.
  constexpr int kMaxRounds = 8;
  for (int round = 0;; ++round) {
    const std::shared_ptr<const VisibilityBuffers> buffers = draw(*mesh);
    FacetVisibility visibility = FindVisibleFacets(*buffers);
    if (round == kMaxRounds) {
      return visibility;
    }
    const FixedVertices fixed = FixedOf(*fixed_sources);
    const std::vector<uint8_t> is_large =
        FindLarge(max_area, *mesh, buffers->Views(), visibility, fixed);
    if (std::count(is_large.begin(), is_large.end(), 1) == 0) {
      return visibility;
    }
    visibility = {};  // large where hundreds of images see each facet
    Subdivision subdivision = Subdivide(*mesh, is_large, fixed);
    *attributes = InterpolateAttributes(*attributes, subdivision.sources);
    *origins = Midpoints(*origins, subdivision.sources);
    *mesh = std::move(subdivision.mesh);
    if (!fixed.empty()) {
      fixed_sources->resize(mesh->vertices.size(), kNone);
    }
  }
}

}  // namespace colmap_ext
