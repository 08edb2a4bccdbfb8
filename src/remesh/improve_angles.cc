#include "remesh/improve_angles.h"

#include <utility>

#include "remesh/anchored_mesh.h"
#include "remesh/collapse_short_edges.h"
#include "remesh/edge_length_field.h"
#include "remesh/flip_edges.h"
#include "remesh/reference_surface.h"
#include "remesh/relax_vertices.h"

namespace colmap_ext {
namespace {

// [V] whether a vertex is a corner of a facet with a small angle.
std::vector<uint8_t> CornersOfThinFacets(const AnchoredMesh& mesh,
                                         float min_cosine) {
  std::vector<uint8_t> is_corner(mesh.edit.NumVertices(), 0);
  for (uint32_t facet = 0; facet < mesh.edit.NumFacets(); ++facet) {
    if (!mesh.edit.IsRemovedFacet(facet) &&
        LargestCosine(mesh.Corners(3 * facet)) > min_cosine) {
      for (const uint32_t vertex : mesh.edit.FacetAt(facet)) {
        is_corner[vertex] = 1;
      }
    }
  }
  return is_corner;
}

}  // namespace

ImprovedMesh ImproveAngles(const TriangleMesh& mesh,
                           const FixedVertices& fixed) {
  constexpr float kMinCosine = 0.906F;  // 25 degrees: a choice
  constexpr float kMaxRatio = 2;        // edges may get so long
  constexpr int kIterations = 3;        // later ones find next to nothing
  std::vector<float> lengths = MeanEdgeLengths(mesh);
  const std::vector<float> tolerances = TolerancesOf(lengths);
  const ReferenceSurface reference(mesh, std::move(lengths), tolerances);
  AnchoredMesh work(mesh, reference, fixed);
  for (int i = 0; i < kIterations; ++i) {
    FlipForAngles(reference, kMinCosine, &work);
    RelaxVertices(reference, CornersOfThinFacets(work, kMinCosine), &work);
    CollapseNeedles(reference, kMaxRatio, &work);
  }
  FlipForAngles(reference, kMinCosine, &work);
  CompactMesh compact = work.edit.Compact();
  ImprovedMesh improved{
      std::move(compact.mesh), {}, std::move(compact.facets), {}};
  for (const uint32_t vertex : compact.vertices) {
    improved.sources.push_back(work.anchors[vertex].source);
    if (!fixed.empty()) {
      improved.fixed_sources.push_back(IsFixed(fixed, vertex) ? vertex : kNone);
    }
  }
  return improved;
}

}  // namespace colmap_ext
