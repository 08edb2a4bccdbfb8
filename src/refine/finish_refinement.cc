#include "refine/finish_refinement.h"

#include <stdexcept>
#include <utility>

#include "mesh/clip_mesh.h"
#include "mesh/vertex_confidences.h"
#include "remesh/carry_attributes.h"
#include "remesh/improve_angles.h"
#include "repair/self_intersection_repair.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

namespace {

// Trims the mesh and closes its holes.
void FinishBorders(const BorderOptions& options, RefinedMesh* refined) {
  const std::vector<float> facet_confidences =
      MeanOfCorners(refined->mesh.facets, refined->attributes.confidences);
  EditedMesh edited =
      EditBorders(options, std::move(refined->mesh),
                  std::move(refined->attributes), facet_confidences);
  std::vector<Eigen::Vector3f> origins = edited.mesh.vertices;
  for (size_t i = 0; i < origins.size(); ++i) {
    if (edited.vertex_sources[i] != kNone) {
      origins[i] = refined->origins[edited.vertex_sources[i]];
    }
  }
  refined->mesh = std::move(edited.mesh);
  refined->attributes = std::move(edited.attributes);
  refined->origins = std::move(origins);
  refined->labels = refined->labels.Remapped(edited.facet_sources);
  refined->report.borders = edited.report;
}

// Cuts off what lies outside of the region.
// \return whether anything does
bool CutOffOutside(const Region& region, RefinedMesh* refined) {
  CutMesh cut =
      CutOff(region, std::move(refined->mesh), std::move(refined->attributes));
  if (cut.mesh.facets.empty()) {
    throw std::invalid_argument(
        "no face of the refined mesh lies in the region: take a larger one");
  }
  const bool is_cut = cut.facet_sources.size() != refined->labels.NumFacets();
  refined->mesh = std::move(cut.mesh);
  refined->attributes = std::move(cut.attributes);
  refined->origins = refined->mesh.vertices;  // no step follows
  refined->labels = refined->labels.Remapped(cut.facet_sources);
  return is_cut;
}

}  // namespace

void ImproveFacets(RefinedMesh* state) {
  ImprovedMesh improved =
      ImproveAngles(state->mesh, FixedOf(state->fixed_sources));
  FixedSources fixed =
      CarrySources(state->fixed_sources, improved.fixed_sources);
  const size_t num_crossing =
      RepairSelfIntersections(&improved.mesh, kMaxRepairRounds, FixedOf(fixed))
          .num_after;
  if (num_crossing > state->report.num_self_intersections) {
    return;
  }
  state->report.num_self_intersections = num_crossing;
  state->attributes =
      CarryAttributes(state->mesh, state->attributes, improved.sources);
  state->origins = ValuesAt(improved.sources, state->mesh, state->origins);
  state->labels = state->labels.Remapped(improved.facet_sources);
  state->mesh = std::move(improved.mesh);
  state->fixed_sources = std::move(fixed);
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
  if (refined->report.is_skipped) {
    CountSelfIntersections(progress, refined);
  } else {
    Report(progress, "Finishing the borders", 0);
    FinishBorders(options.borders, refined);
    RemoveSelfIntersections(progress, refined);
  }
  const bool is_cut = options.region && CutOffOutside(*options.region, refined);
  const BorderReport& borders = refined->report.borders;
  const bool have_changed =
      is_cut || borders.trim.num_facets > 0 || borders.holes.num_closed > 0;
  if (options.remeshing && have_changed && !refined->report.is_skipped) {
    ImproveFacets(refined);
  }
}

}  // namespace colmap_ext
