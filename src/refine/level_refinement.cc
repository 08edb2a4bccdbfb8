#include "refine/level_refinement.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "refine/refined_confidences.h"
#include "refine/smoothness_model.h"
#include "refine/vertex_motion.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

// A level at work. The members after the tree change from step to step.
class LevelRefinement {
 public:
  LevelRefinement(const FacetwiseRefinementOptions& options,
                  RefinementLevel level, TriangleMesh mesh,
                  PhotometricEnergy* energy, const OnLevelStep& on_step)
      : options_(options),
        level_(std::move(level)),
        energy_(energy),
        on_step_(on_step),
        tree_(mesh) {
    const bool is_classical =
        options.labeling.pair_selection == PairSelection::kClassical;
    labels_ = level_.labels.Truncated(
        is_classical ? SIZE_MAX : options.labeling.pairs_per_facet);
    domain_.rings = MakeVertexRings(mesh);
    surface_.mesh = std::move(mesh);
  }

  RefinedLevel Run() {
    // Weight of the smoothness before the surface is measured. At the finest
    // level an iteration changes it by a factor of 4.
    constexpr double kFirstWeight = 20;
    Draw();
    const std::vector<uint8_t> is_confirmed =
        ConfirmedFacets(surface_.mesh, domain_.rings, surface_.terms,
                        options_.photometric, options_.min_zncc);
    CompleteDomain();
    std::vector<FacetTerms> unconfirmed;
    for (size_t i = 0; i < is_confirmed.size(); ++i) {
      if (is_confirmed[i] == 0) {
        unconfirmed.push_back(surface_.terms.facets[i]);
      }
    }
    if (!unconfirmed.empty()) {
      labels_.KeepOf(is_confirmed);
      level_.labels.KeepOf(is_confirmed);
      surface_ = Evaluate(std::move(surface_.mesh));
    }
    SetTarget(FirstTarget(domain_, surface_.mesh,
                          kFirstWeight * options_.smoothness_weight));
    Iterate(options_.iterations);
    if (level_.level == 0 && !refined_.is_stopped &&
        labels_.labels.values.size() < level_.labels.labels.values.size()) {
      Finish();
    }
    for (size_t i = 0, next = 0; i < is_confirmed.size(); ++i) {
      if (is_confirmed[i] == 0) {
        surface_.terms.facets[i] = unconfirmed[next++];
      }
    }
    refined_.mesh = std::move(surface_.mesh);
    refined_.terms = std::move(surface_.terms);
    return std::move(refined_);
  }

 private:
  // As the mesh was drawn last.
  EvaluatedSurface Evaluate(TriangleMesh mesh) const {
    PhotometricTerms terms = energy_->Evaluate(mesh, labels_);
    std::vector<Eigen::Vector3f> normals = VertexNormals(mesh, domain_.rings);
    return {std::move(mesh), std::move(normals), std::move(terms)};
  }

  // Draws the mesh, so that its visibility is that of its present position.
  void Draw() {
    energy_->Render(surface_.mesh);
    surface_ = Evaluate(std::move(surface_.mesh));
    drift_ = 0;
  }

  void SetTarget(SmoothnessTarget target) {
    smoothness_ = MakeSmoothnessModel(std::move(target), domain_, surface_);
  }

  double Energy() const {
    return surface_.terms.energy + smoothness_.plate.Energy();
  }

  // \pre the surface has the terms of all facets, confirmed or not.
  void CompleteDomain() {
    domain_.fixed = level_.fixed;
    domain_.footprints = VertexFootprints(surface_.mesh, domain_.rings,
                                          level_.labels, level_.views);
    domain_.num_pixels =
        PixelsOfVertices(surface_.mesh, surface_.terms, domain_.footprints);
    domain_.is_seen = SeenVertices(surface_.mesh, surface_.terms);
    if (level_.level == 0) {
      domain_.trusted_relief =
          TrustedRelief({level_.origins, surface_.mesh.facets}, domain_.rings,
                        domain_.footprints);
      for (size_t i = 0; i < domain_.is_seen.size(); ++i) {
        if (domain_.is_seen[i] == 0) {
          domain_.trusted_relief[i] = 0;
        }
      }
    }
  }

  // Runs at most so many steps.
  void Iterate(int max_iterations) {
    // Mean motion since the mesh was drawn, px, above which it is drawn again.
    // Below it, visibility changes by less than a window.
    constexpr double kMaxDrift = 0.1;
    // Relative decrease of the energy below which the iterations end, at the
    // finest level and at coarser ones, whose result finer ones continue from.
    // Found by trial.
    constexpr double kMinGain = 2e-4;
    constexpr double kMinCoarseGain = 1e-3;
    const double min_gain = level_.level == 0 ? kMinGain : kMinCoarseGain;
    Report(0);
    for (int i = 0; i < max_iterations && !refined_.is_stopped; ++i) {
      if (drift_ > kMaxDrift) {
        Draw();
      }
      if (level_.level == 0 && smoothness_.target.weight > 0) {
        AdaptSmoothness();
      }
      const double before = Energy();
      const double mean_motion = Step();
      if (!(mean_motion > 0)) {
        break;
      }
      ++iteration_;
      drift_ += mean_motion;
      Report(mean_motion);
      if (before - Energy() < min_gain * std::abs(before)) {
        break;
      }
    }
  }

  // The smoothness that the surface itself calls for, at the finest level.
  void AdaptSmoothness() {
    // Iterations without regard to the input's relief, so that what the surface
    // then has of it comes from the images. Found by trial;
    // tests/benchmarks/vary_constants.py tables what other values do.
    constexpr int kBlindIterations = 2;
    if (iteration_ >= kBlindIterations) {
      SetTarget(ConfirmRelief(domain_, smoothness_));
    }
    SetTarget(EstimateWeights(domain_, surface_, smoothness_,
                              options_.smoothness_weight));
  }

  // Makes the energy fall.
  // \return the mean motion, px; 0 if no step makes it fall.
  double Step() {
    constexpr int kMaxTrials = 3;  // the whole step, half and a quarter of it
    // Of the solution: the normal equations take the energy to be more curved
    // than it is. Found by trial (docs/experiments.md).
    constexpr double kRelaxation = 1.5;
    std::vector<double> motion = SolveForMotion();
    for (double& distance : motion) {
      distance *= kRelaxation;
    }
    LimitMotion(surface_.mesh, domain_.rings, domain_.footprints, &motion);
    for (int trial = 0; trial < kMaxTrials; ++trial) {
      MovedMesh moved = MoveSafely(surface_.mesh, domain_.rings,
                                   surface_.normals, std::move(motion), &tree_);
      motion = std::move(moved.motion);
      EvaluatedSurface next = Evaluate(std::move(moved.mesh));
      ThinPlate plate = PlateOf(smoothness_.target, domain_, next);
      if (next.terms.energy + plate.Energy() < Energy()) {
        surface_ = std::move(next);
        smoothness_.plate = std::move(plate);
        return MeanMotion(motion, domain_.footprints, domain_.fixed);
      }
      for (double& distance : motion) {
        distance /= 2;
      }
    }
    return 0;
  }

  // [V] along the normals, scene units.
  std::vector<double> SolveForMotion() {
    const NormalEquations equations(surface_, domain_, smoothness_.plate);
    if (options_.solver == RefinementSolver::kGaussNewton) {
      return equations.Solve();
    }
    std::vector<double> motion(surface_.mesh.vertices.size(), 0);
    for (size_t i = 0; i < motion.size(); ++i) {
      if (equations.Diagonal()[i] > 0) {
        motion[i] = -equations.Gradient()[i] / equations.Diagonal()[i];
      }
    }
    return motion;
  }

  // Reports a step, and stops where that is requested.
  // \param mean_motion  of the step, px.
  void Report(double mean_motion) {
    double weight = 0;
    for (const FacetTerms& facet : surface_.terms.facets) {
      weight += facet.weight;
    }
    RefinementStep step;
    step.level = level_.level;
    step.is_final = is_final_;
    step.num_pairs = labels_.MaxLabelsOfFacet();
    step.iteration = iteration_;
    step.energy = Energy();
    step.photometric_energy = surface_.terms.energy;
    step.mean_zncc =
        MeanZncc(surface_.terms.energy, weight, options_.photometric);
    step.mean_step = mean_motion;
    step.num_vertices = surface_.mesh.vertices.size();
    step.num_facets = surface_.mesh.facets.size();
    refined_.is_stopped = !on_step_(step, surface_.mesh);
  }

  // The final iterations, half of them by a part of the labels, if that is
  // fewer.
  void Finish() {
    constexpr int kFinalIterations = 4;
    FacetLabels labels = std::move(level_.labels);
    const auto num_first =
        static_cast<size_t>(options_.labeling.FirstFinalPairs());
    const bool is_by_part = labels.MaxLabelsOfFacet() > num_first;
    if (is_by_part) {
      ContinueWithLabels(labels.Truncated(num_first), kFinalIterations / 2);
    }
    if (!refined_.is_stopped) {
      ContinueWithLabels(std::move(labels),
                         is_by_part ? kFinalIterations / 2 : kFinalIterations);
    }
  }

  // Continues from the current surface with more labels: it is drawn again, and
  // its vertices account for more pixels.
  void ContinueWithLabels(FacetLabels labels, int num_iterations) {
    labels_ = InSmallerView(std::move(labels), surface_.mesh, level_.views);
    is_final_ = true;
    Draw();
    domain_.num_pixels =
        PixelsOfVertices(surface_.mesh, surface_.terms, domain_.footprints);
    SetTarget(std::move(smoothness_.target));
    Iterate(num_iterations);
  }

  const FacetwiseRefinementOptions& options_;
  RefinementLevel level_;
  PhotometricEnergy* energy_;
  const OnLevelStep& on_step_;
  FacetTree tree_;      // of the mesh's facets
  FacetLabels labels_;  // that the steps use
  bool is_final_ = false;
  SmoothnessDomain domain_;
  EvaluatedSurface surface_;
  SmoothnessModel smoothness_;
  int iteration_ = 0;
  double drift_ = 0;      // px, mean motion since the mesh was drawn
  RefinedLevel refined_;  // without its mesh and terms
};

}  // namespace

RefinedLevel RefineLevel(const FacetwiseRefinementOptions& options,
                         RefinementLevel level, TriangleMesh mesh,
                         PhotometricEnergy* energy,
                         const OnLevelStep& on_step) {
  return LevelRefinement(options, std::move(level), std::move(mesh), energy,
                         on_step)
      .Run();
}

}  // namespace colmap_ext
