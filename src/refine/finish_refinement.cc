#include "refine/facetwise_refinement.h"

#include <stdexcept>
#include <utility>

#include "mesh/clip_mesh.h"
#include "mesh/confidences.h"
#include "remesh/isotropic_remeshing.h"
#include "repair/self_intersection_repair.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

void ImproveFacets(RefinedMesh* state) {
  RemeshedSurface improved =
      ImproveAngles(state->mesh, FixedOf(state->fixed_sources));
  const size_t num_crossing =
      RepairSelfIntersections(&improved.mesh, kMaxRepairRounds,
                              FixedOf(improved.fixed_sources))
          .num_after;
  if (num_crossing > state->report.num_self_intersections) {
    return;
  }
  state->report.num_self_intersections = num_crossing;
  state->labels = state->labels.Remapped(improved.facet_sources);
  BecomeRemeshed(std::move(improved), state);
}

void CountSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Looking for self-intersections", 0);
  state->report.num_self_intersections =
      FindSelfIntersections(state->mesh).size();
}

bool RemoveSelfIntersections(const Progress& progress, RefinedMesh* state) {
  Report(progress, "Repairing self-intersections", 0);
  const SelfIntersectionRepair repair = RepairSelfIntersections(
      &state->mesh, kMaxRepairRounds, FixedOf(state->fixed_sources));
  state->report.num_removed_self_intersections +=
      repair.num_before - repair.num_after;
  state->report.num_self_intersections = repair.num_after;
  return repair.num_after < repair.num_before;
}

void FinishRefinement(const FacetwiseRefinementOptions& options,
                      const Progress& progress, RefinedMesh* refined) {
  RefinementReport& report = refined->report;
  if (report.is_skipped) {
    CountSelfIntersections(progress, refined);
  } else {
    Report(progress, "Finishing the borders", 0);
    const Provenance from = EditBorders(
        options.borders,
        MeanOfCorners(refined->mesh.facets, refined->attributes.confidences),
        refined->views, refined, &report.borders);
    refined->labels = refined->labels.Remapped(from.facets);
    RemoveSelfIntersections(progress, refined);
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
    ImproveFacets(refined);
  }
}

}  // namespace colmap_ext
