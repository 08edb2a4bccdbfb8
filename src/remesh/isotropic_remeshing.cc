#include "remesh/isotropic_remeshing.h"

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

RemeshedSurface RemeshIsotropically(const TriangleMesh& mesh,
                                    const std::vector<float>& lengths,
                                    const std::vector<float>& tolerances) {
  // An edge is split or collapsed where its halves, or the edge twice as long,
  // come closer to the wanted length [Botsch2004].
  constexpr float kMaxRatio = 4.0F / 3;
  constexpr float kMinRatio = 4.0F / 5;
  constexpr float kNeedleRatio = 2;  // edges may get so long to end a needle
  constexpr float kAllFacets = 0;    // have an angle of less than 90 degrees
  constexpr int kIterations = 5;     // as [Botsch2004] has them
  const ReferenceSurface reference(mesh, lengths, tolerances);
  AnchoredMesh work(mesh, reference);
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
    remeshed.sources.push_back(work.anchors[compact.vertices[vertex]].source);
  }
  return remeshed;
}

}  // namespace colmap_ext
