#include "refine/level_refinement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "labeling/facet_labels.h"
#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "refine/normal_equations.h"
#include "refine/refined_confidences.h"
#include "refine/smoothness_model.h"
#include "refine/thin_plate.h"
#include "refine/vertex_motion.h"
#include "refine/vertex_pixels.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

namespace {

// What does not change as long as the same labels are used.
struct Stage {
  const FacetwiseRefinementOptions& options;
  int level = 0;
  bool is_final = false;
  int max_iterations = 0;
  FacetLabels labels;
  SmoothnessDomain domain;
  PhotometricEnergy* energy = nullptr;
  FacetTree* tree = nullptr;  // of the mesh's facets
  const OnLevelStep& on_step;
};

// What each iteration changes.
struct State {
  EvaluatedSurface surface;
  SmoothnessModel smoothness;
  int iteration = 0;
  double drift = 0;  // px, mean motion since the mesh was drawn
  bool is_stopped = false;
  size_t num_shortened_steps = 0;
  size_t num_unconverged_solutions = 0;

  double Energy() const {
    return surface.terms.energy + smoothness.plate.Energy();
  }
};

// As the mesh was drawn last.
EvaluatedSurface EvaluateSurface(TriangleMesh mesh, const Stage& stage) {
  PhotometricTerms terms = stage.energy->Evaluate(mesh, stage.labels);
  std::vector<Eigen::Vector3f> normals =
      VertexNormals(mesh, stage.domain.rings);
  return {std::move(mesh), std::move(normals), std::move(terms)};
}

// Draws the mesh, so that its visibility is that of its present position.
EvaluatedSurface DrawSurface(TriangleMesh mesh, const Stage& stage) {
  stage.energy->Render(mesh);
  return EvaluateSurface(std::move(mesh), stage);
}

// Terms of the facets that are not chosen are those of `others`.
// \param is_chosen [F]
void TakeOthers(const std::vector<uint8_t>& is_chosen,
                const PhotometricTerms& others, PhotometricTerms* terms) {
  for (size_t i = 0; i < is_chosen.size(); ++i) {
    if (is_chosen[i] == 0) {
      terms->facets[i].energy = others.facets[i].energy;
      terms->facets[i].weight = others.facets[i].weight;
      terms->facets[i].num_pixels = others.facets[i].num_pixels;
    }
  }
}

std::vector<double> TrustedReliefWhereSeen(const RefinementLevel& level,
                                           const TriangleMesh& mesh,
                                           const SmoothnessDomain& domain) {
  std::vector<double> relief = TrustedRelief({level.origins, mesh.facets},
                                             domain.rings, domain.footprints);
  for (size_t i = 0; i < relief.size(); ++i) {
    if (domain.is_seen[i] == 0) {
      relief[i] = 0;
    }
  }
  return relief;
}

// \param surface  with the terms of all facets, confirmed or not.
SmoothnessDomain MakeDomain(const RefinementLevel& level,
                            const EvaluatedSurface& surface,
                            VertexRings rings) {
  SmoothnessDomain domain;
  domain.rings = std::move(rings);
  domain.fixed = level.fixed;
  domain.footprints =
      VertexFootprints(surface.mesh, domain.rings, level.labels, level.views);
  domain.num_pixels =
      PixelsOfVertices(surface.mesh, surface.terms, domain.footprints);
  domain.is_seen = SeenVertices(surface.mesh, surface.terms);
  if (level.level == 0) {
    domain.trusted_relief = TrustedReliefWhereSeen(level, surface.mesh, domain);
  }
  return domain;
}

// The smoothness that the surface itself calls for, at the finest level.
State AdaptSmoothness(const Stage& stage, State state) {
  // Iterations without regard to the input's relief, so that what the surface
  // then has of it comes from the images. Found by trial;
  // tests/benchmarks/vary_constants.py tables what other values do.
  constexpr int kBlindIterations = 2;
  const SmoothnessDomain& domain = stage.domain;
  if (state.iteration >= kBlindIterations) {
    state.smoothness = MakeSmoothnessModel(
        ConfirmRelief(domain, state.smoothness), domain, state.surface);
  }
  SmoothnessTarget target = EstimateWeights(
      domain, state.surface, state.smoothness, stage.options.smoothness_weight,
      &state.num_unconverged_solutions);
  state.smoothness =
      MakeSmoothnessModel(std::move(target), domain, state.surface);
  return state;
}

// [V] along the normals, scene units.
std::vector<double> SolveForMotion(const Stage& stage, State* state) {
  const EvaluatedSurface& surface = state->surface;
  const NormalEquations equations(surface.mesh, surface.normals,
                                  stage.domain.rings, surface.terms,
                                  state->smoothness.plate, stage.domain.fixed);
  if (stage.options.solver == RefinementSolver::kGaussNewton) {
    LinearSolution solution = equations.Solve();
    state->num_unconverged_solutions += solution.is_converged ? 0 : 1;
    return std::move(solution.values);
  }
  std::vector<double> motion(surface.mesh.vertices.size(), 0);
  for (size_t i = 0; i < motion.size(); ++i) {
    if (equations.Diagonal()[i] > 0) {
      motion[i] = -equations.Gradient()[i] / equations.Diagonal()[i];
    }
  }
  return motion;
}

// Makes the energy fall.
// \return the mean motion, px; 0 if no step makes it fall.
double Step(const Stage& stage, State* state) {
  constexpr int kMaxTrials = 3;  // the whole step, half and a quarter of it
  // Of the solution: the normal equations take the energy to be more curved
  // than it is. Found by trial (docs/experiments.md).
  constexpr double kRelaxation = 1.5;
  const SmoothnessDomain& domain = stage.domain;
  std::vector<double> motion = SolveForMotion(stage, state);
  for (double& distance : motion) {
    distance *= kRelaxation;
  }
  LimitMotion(state->surface.mesh, domain.rings, domain.footprints, &motion);
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    MovedMesh moved =
        MoveSafely(state->surface.mesh, domain.rings, state->surface.normals,
                   std::move(motion), stage.tree);
    state->num_shortened_steps +=
        std::count(moved.is_shortened.begin(), moved.is_shortened.end(), 1);
    motion = std::move(moved.motion);
    EvaluatedSurface next = EvaluateSurface(std::move(moved.mesh), stage);
    ThinPlate plate = PlateOf(state->smoothness.target, domain, next);
    if (next.terms.energy + plate.Energy() < state->Energy()) {
      state->surface = std::move(next);
      state->smoothness.plate = std::move(plate);
      return MeanMotion(motion, domain.footprints, domain.fixed);
    }
    for (double& distance : motion) {
      distance /= 2;
    }
  }
  return 0;
}

// Over the pixels that are compared.
double MeanZnccOfAll(const PhotometricTerms& terms,
                     const PhotometricOptions& options) {
  double weight = 0;
  for (const FacetTerms& facet : terms.facets) {
    weight += facet.weight;
  }
  return MeanZncc(terms.energy, weight, options);
}

// \param mean_motion  of the step, px.
// \return whether to continue.
bool Report(const Stage& stage, const State& state, double mean_motion) {
  RefinementStep step;
  step.level = stage.level;
  step.is_final = stage.is_final;
  step.num_pairs = stage.labels.MaxLabelsOfFacet();
  step.iteration = state.iteration;
  step.energy = state.Energy();
  step.photometric_energy = state.surface.terms.energy;
  step.mean_zncc =
      MeanZnccOfAll(state.surface.terms, stage.options.photometric);
  step.mean_step = mean_motion;
  step.num_vertices = state.surface.mesh.vertices.size();
  step.num_facets = state.surface.mesh.facets.size();
  return stage.on_step(step, state.surface.mesh);
}

// Runs at most stage.max_iterations steps.
State Iterate(const Stage& stage, State state) {
  // Mean motion since the mesh was drawn, px, above which it is drawn again.
  // Below it, visibility changes by less than a window.
  constexpr double kMaxDrift = 0.1;
  // Relative decrease of the energy below which the iterations end; finer
  // levels continue from the result of a coarser one. Found by trial.
  const double min_gain = stage.level == 0 ? 2e-4 : 1e-3;
  state.is_stopped = !Report(stage, state, 0);
  for (int i = 0; i < stage.max_iterations && !state.is_stopped; ++i) {
    if (state.drift > kMaxDrift) {
      state.surface = DrawSurface(std::move(state.surface.mesh), stage);
      state.drift = 0;
    }
    if (stage.level == 0 && state.smoothness.target.weight > 0) {
      state = AdaptSmoothness(stage, std::move(state));
    }
    const double before = state.Energy();
    const double mean_motion = Step(stage, &state);
    if (!(mean_motion > 0)) {
      break;
    }
    ++state.iteration;
    state.drift += mean_motion;
    state.is_stopped = !Report(stage, state, mean_motion);
    if (before - state.Energy() < min_gain * std::abs(before)) {
      break;
    }
  }
  return state;
}

// The cameras move, and the surface follows them.
State FollowCameras(const RefinementLevel& level, const Stage& stage,
                    State state) {
  if (state.is_stopped || !level.move_cameras) {
    return state;
  }
  const bool is_to_follow = level.move_cameras(state.surface.mesh);
  state.surface = DrawSurface(std::move(state.surface.mesh), stage);
  state.drift = 0;
  return is_to_follow ? Iterate(stage, std::move(state)) : std::move(state);
}

// Continues from the current surface with more labels: it is drawn again, and
// its vertices account for more pixels.
State ContinueWithLabels(FacetLabels labels, int num_iterations, Stage* stage,
                         State state) {
  stage->labels = std::move(labels);
  stage->is_final = true;
  stage->max_iterations = num_iterations;
  SmoothnessDomain& domain = stage->domain;
  state.surface = DrawSurface(std::move(state.surface.mesh), *stage);
  state.drift = 0;
  domain.num_pixels = PixelsOfVertices(state.surface.mesh, state.surface.terms,
                                       domain.footprints);
  state.smoothness = MakeSmoothnessModel(std::move(state.smoothness.target),
                                         domain, state.surface);
  return Iterate(*stage, std::move(state));
}

// The final iterations, the first of them by a part of the labels.
State Finish(FacetLabels labels, const std::vector<View>& views, Stage* stage,
             State state) {
  constexpr int kIterations = 2;
  const auto num_first =
      static_cast<size_t>(stage->options.labeling.FirstFinalPairs());
  const bool is_by_part = labels.MaxLabelsOfFacet() > num_first;
  const auto in_smaller_view = [&](FacetLabels chosen) {
    return InSmallerView(std::move(chosen), state.surface.mesh, views);
  };
  if (is_by_part) {
    FacetLabels part = in_smaller_view(labels.Truncated(num_first));
    state = ContinueWithLabels(std::move(part), kIterations, stage,
                               std::move(state));
  }
  if (state.is_stopped) {
    return state;
  }
  labels = in_smaller_view(std::move(labels));
  return ContinueWithLabels(std::move(labels),
                            is_by_part ? kIterations : 2 * kIterations, stage,
                            std::move(state));
}

}  // namespace

RefinedLevel RefineLevel(const FacetwiseRefinementOptions& options,
                         const RefinementLevel& level, TriangleMesh mesh,
                         PhotometricEnergy* energy,
                         const OnLevelStep& on_step) {
  // Weight of the smoothness before the surface is measured. At the finest
  // level an iteration changes it by a factor of 4.
  constexpr double kFirstWeight = 20;
  const bool is_classical =
      options.labeling.pair_selection == PairSelection::kClassical;
  FacetTree tree(mesh);
  Stage stage{options,
              level.level,
              false,
              options.iterations,
              level.labels.Truncated(
                  is_classical ? SIZE_MAX : options.labeling.pairs_per_facet),
              {},
              energy,
              &tree,
              on_step};
  stage.domain.rings = MakeVertexRings(mesh);
  State state;
  state.surface = DrawSurface(std::move(mesh), stage);
  const std::vector<uint8_t> is_confirmed = ConfirmedFacets(
      state.surface.mesh, stage.domain.rings, state.surface.terms,
      options.photometric, options.min_zncc);
  stage.domain =
      MakeDomain(level, state.surface, std::move(stage.domain.rings));
  const bool is_all_confirmed =
      std::count(is_confirmed.begin(), is_confirmed.end(), 0) == 0;
  PhotometricTerms first_terms;
  if (!is_all_confirmed) {
    stage.labels = stage.labels.Masked(is_confirmed);
    first_terms = std::move(state.surface.terms);
    state.surface = EvaluateSurface(std::move(state.surface.mesh), stage);
  }
  state.smoothness =
      MakeSmoothnessModel(FirstTarget(stage.domain, state.surface.mesh,
                                      kFirstWeight * options.smoothness_weight),
                          stage.domain, state.surface);
  state = FollowCameras(level, stage, Iterate(stage, std::move(state)));
  FacetLabels labels = level.labels.Masked(is_confirmed);
  if (level.level == 0 && !state.is_stopped &&
      stage.labels.labels.values.size() < labels.labels.values.size()) {
    state = Finish(std::move(labels), level.views, &stage, std::move(state));
  }
  if (!is_all_confirmed) {
    TakeOthers(is_confirmed, first_terms, &state.surface.terms);
  }
  return {std::move(state.surface.mesh), std::move(state.surface.terms),
          state.is_stopped, state.num_shortened_steps,
          state.num_unconverged_solutions};
}

}  // namespace colmap_ext
