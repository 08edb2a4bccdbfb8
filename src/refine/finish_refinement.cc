#include <stdexcept>
#include <utility>

#include "base/indices.h"
#include "mesh/adjacency.h"
#include "mesh/clip_mesh.h"
#include "mesh/confidences.h"
#include "refine/facetwise_refinement.h"
#include "remesh/isotropic_remeshing.h"
#include "repair/self_intersection_repair.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

void ImproveFacets(RefinedMesh* state) {
  // Choices; 2 rings are what a flip and a step of a vertex change.
  constexpr int kMaxTrials = 4;
  constexpr int kRings = 2;
  const FixedVertices fixed = FixedOf(state->fixed_sources);
  FixedVertices is_left_alone = fixed;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    RemeshedSurface improved = ImproveAngles(state->mesh, is_left_alone);
    for (uint32_t& source : improved.fixed_sources) {
      source = source != kNone && IsFixed(fixed, source) ? source : kNone;
    }
    const size_t num_crossing =
        RepairSelfIntersections(&improved.mesh, FixedOf(improved.fixed_sources))
            .num_after;
    if (num_crossing <= state->report.num_self_intersections) {
      state->report.num_self_intersections = num_crossing;
      state->labels = state->labels.Remapped(improved.facet_sources);
      BecomeRemeshed(std::move(improved), state);
      return;
    }
    // The surroundings of what crosses are left as they are.
    std::vector<FacetPair> crossing = FindSelfIntersections(improved.mesh);
    for (auto& [a, b] : crossing) {
      a = improved.facet_sources[a];
      b = improved.facet_sources[b];
    }
    is_left_alone.resize(state->mesh.vertices.size(), 0);
    const std::vector<uint32_t> around =
        Marked(MarkAround(state->mesh, crossing, kRings));
    for (const uint32_t vertex : VerticesOf(state->mesh, around)) {
      is_left_alone[vertex] = 1;
    }
  }
}

void CountSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Looking for self-intersections", 0);
  state->report.num_self_intersections =
      FindSelfIntersections(state->mesh).size();
}

bool RemoveSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Repairing self-intersections", 0);
  const SelfIntersectionRepair repair =
      RepairSelfIntersections(&state->mesh, FixedOf(state->fixed_sources));
  state->report.num_removed_self_intersections +=
      repair.num_before - repair.num_after;
  state->report.num_self_intersections = repair.num_after;
  return repair.num_after < repair.num_before;
}

void FinishRefinement(const FacetwiseRefinementOptions& options,
                      const Progress& progress,
                      const std::vector<float>& front_shares,
                      RefinedMesh* refined) {
  RefinementReport& report = refined->report;
  if (report.is_skipped) {
    CountSelfIntersections(progress, refined);
  } else {
    Report(progress, "Finishing the borders", 0);
    const Provenance from = TrimAndCloseHoles(
        options.borders,
        MeanOfCorners(refined->mesh.facets, refined->attributes.confidences),
        refined->views, refined, &report.borders, front_shares);
    refined->labels = refined->labels.Remapped(from.facets);
    RemoveSelfIntersections(progress, refined);
    report.num_removed_self_intersections += report.num_self_intersections;
    refined->labels = refined->labels.Remapped(
        FinishRepair(&report.num_self_intersections, refined).facets);
    report.num_removed_self_intersections -= report.num_self_intersections;
    Unfold(&refined->mesh, FixedOf(refined->fixed_sources));
  }
  bool have_changed =
      report.borders.trim.num_facets > 0 || report.borders.holes.num_closed > 0;
  if (options.region) {
    if (const auto from = CutOff(*options.region, refined)) {
      refined->labels = refined->labels.Remapped(from->facets);
      have_changed = true;
    }
    if (refined->mesh.facets.empty()) {
      throw std::invalid_argument(
          "no face of the refined mesh lies in the region: take a larger one");
    }
  }
  if (options.remeshing && have_changed && !report.is_skipped) {
    // One folds edges, the other thins facets; 4 rounds, a choice, end both.
    for (int round = 0; round < 4; ++round) {
      ImproveFacets(refined);
      Unfold(&refined->mesh, FixedOf(refined->fixed_sources));
    }
  }
}

}  // namespace colmap_ext
