#include "remesh/isotropic_remeshing.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "mesh/space_filling_curve.h"
#include "remesh/anchored_mesh.h"
#include "remesh/collapse_short_edges.h"
#include "remesh/flip_edges.h"
#include "remesh/reference_surface.h"
#include "remesh/relax_vertices.h"
#include "remesh/split_long_edges.h"

namespace colmap_ext {
namespace {

// Lengths that allow for the edges that stay: beside a longer one no split
// would ever make edges short enough.
std::vector<float> WithFixedEdges(const TriangleMesh& mesh,
                                  const FixedVertices& fixed,
                                  std::vector<float> lengths) {
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; !fixed.empty() && k < 3; ++k) {
      const uint32_t a = facet[k];
      const uint32_t b = facet[(k + 1) % 3];
      if (IsFixed(fixed, a) && IsFixed(fixed, b)) {
        const float length = (mesh.vertices[a] - mesh.vertices[b]).norm();
        lengths[a] = std::max(lengths[a], length);
        lengths[b] = std::max(lengths[b], length);
      }
    }
  }
  return lengths;
}

}  // namespace

RemeshedSurface RemeshIsotropically(const TriangleMesh& mesh,
                                    const std::vector<float>& lengths,
                                    const std::vector<float>& tolerances,
                                    const FixedVertices& fixed) {
  // An edge is split or collapsed where its halves, or the edge twice as long,
  // come closer to the wanted length [Botsch2004].
  constexpr float kMaxRatio = 4.0F / 3;
  constexpr float kMinRatio = 4.0F / 5;
  constexpr float kNeedleRatio = 2;  // edges may get so long to end a needle
  constexpr float kAllFacets = 0;    // have an angle of less than 90 degrees
  constexpr int kIterations = 5;     // as [Botsch2004] has them
  const ReferenceSurface reference(mesh, WithFixedEdges(mesh, fixed, lengths),
                                   tolerances);
  AnchoredMesh work(mesh, reference, fixed);
  for (int i = 0; i < kIterations; ++i) {
    SplitLongEdges(reference, kMaxRatio, &work);
    CollapseShortEdges(reference, kMinRatio, kMaxRatio, &work);
    FlipForValence(reference, &work);
    RelaxVertices(reference, {}, &work);
  }
  FlipForAngles(reference, kAllFacets, &work);
  RelaxVertices(reference, {}, &work);
  // What the reference's creases and noise still hold.
  CollapseNeedles(reference, kNeedleRatio, &work);
  FlipForAngles(reference, kAllFacets, &work);
  CollapseNeedles(reference, kNeedleRatio, &work);

  RemeshedSurface remeshed;
  CompactMesh compact = work.edit.Compact();
  remeshed.mesh = std::move(compact.mesh);
  for (const uint32_t vertex : SortAlongCurve(&remeshed.mesh)) {
    const uint32_t old_vertex = compact.vertices[vertex];
    remeshed.sources.push_back(work.anchors[old_vertex].source);
    if (!fixed.empty()) {
      remeshed.fixed_sources.push_back(IsFixed(fixed, old_vertex) ? old_vertex
                                                                  : kNone);
    }
  }
  return remeshed;
}

}  // namespace colmap_ext
