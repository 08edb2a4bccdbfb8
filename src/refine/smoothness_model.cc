#include "refine/smoothness_model.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "refine/normal_equations.h"
#include "refine/smoothness_weights.h"

namespace colmap_ext {

namespace {

// How much a squared residual counts if all weights are 1: [V].
std::vector<double> Importance(const SmoothnessModel& model) {
  std::vector<double> importance = model.plate.coefficients;
  for (size_t i = 0; i < importance.size(); ++i) {
    importance[i] /= model.target.weights[i];
  }
  return importance;
}

// [V] scene units
std::vector<double> OwnRelief(const SmoothnessModel& model) {
  std::vector<double> relief = model.plate.residuals;
  for (size_t i = 0; i < relief.size(); ++i) {
    relief[i] += model.target.relief[i];
  }
  return relief;
}

// The smoothness' energy for a weight of 2: [V], the mean of that with and
// without the confirmed relief. Half of what is confirmed so counts as rough
// still: it is known up to a factor only, and without it other errors of the
// mesh would outweigh the images.
std::vector<double> Roughness(const SmoothnessDomain& domain,
                              const SmoothnessModel& model) {
  std::vector<double> roughness = Importance(model);
  const std::vector<double> own = OwnRelief(model);
  for (size_t i = 0; i < roughness.size(); ++i) {
    const double with = model.plate.residuals[i];
    const double without = domain.is_seen[i] != 0 ? own[i] : with;
    roughness[i] = roughness[i] * (with * with + without * without) / 2;
    if (IsFixed(domain.fixed, static_cast<uint32_t>(i))) {
      roughness[i] = 0;
    }
  }
  return roughness;
}

}  // namespace

SmoothnessTarget FirstTarget(const SmoothnessDomain& domain,
                             const TriangleMesh& mesh, double weight) {
  SmoothnessTarget target;
  target.weight = weight;
  target.weights.assign(mesh.vertices.size(), weight);
  target.relief = Relief(mesh, domain.rings, domain.footprints);
  if (!domain.trusted_relief.empty()) {
    for (size_t i = 0; i < target.relief.size(); ++i) {
      if (domain.is_seen[i] != 0) {
        target.relief[i] = 0;
      }
    }
  }
  return target;
}

ThinPlate PlateOf(const SmoothnessTarget& target,
                  const SmoothnessDomain& domain,
                  const EvaluatedSurface& surface) {
  return MakeThinPlate({surface.mesh.vertices, surface.normals, domain.rings,
                        domain.footprints, domain.num_pixels},
                       target.weights, target.relief);
}

SmoothnessModel MakeSmoothnessModel(SmoothnessTarget target,
                                    const SmoothnessDomain& domain,
                                    const EvaluatedSurface& surface) {
  ThinPlate plate = PlateOf(target, domain, surface);
  return {std::move(target), std::move(plate)};
}

SmoothnessTarget ConfirmRelief(const SmoothnessDomain& domain,
                               const SmoothnessModel& model) {
  const std::vector<double> shares = ReliefShares(
      domain.rings, Importance(model), domain.trusted_relief, OwnRelief(model));
  SmoothnessTarget target = model.target;
  for (size_t i = 0; i < shares.size(); ++i) {
    if (domain.is_seen[i] != 0) {
      target.relief[i] = shares[i] * domain.trusted_relief[i];
    }
  }
  return target;
}

SmoothnessTarget EstimateWeights(const SmoothnessDomain& domain,
                                 const EvaluatedSurface& surface,
                                 const SmoothnessModel& model, double factor,
                                 size_t* num_unconverged) {
  // How many times the energy counts the noise of a pixel: windows overlap, and
  // both directions of several pairs compare it. Found by trial on rendered
  // scenes; rows "half" and "twice the smoothness" of docs/experiments.md show
  // what half and twice do.
  constexpr double kRedundancy = 8;
  // Factor by which the weight may change in an iteration, so that the first
  // estimates, of a rough surface, do not throw it about.
  constexpr double kMaxChange = 4;
  const NormalEquations equations(surface.mesh, surface.normals, domain.rings,
                                  surface.terms, model.plate, domain.fixed);
  LinearSolution determined = equations.Determined();
  *num_unconverged += determined.is_converged ? 0 : 1;
  SmoothnessEvidence evidence{std::move(determined.values),
                              Roughness(domain, model)};
  for (double& share : evidence.determined) {
    share *= factor * kRedundancy;
  }
  SmoothnessTarget target = model.target;
  target.weight = std::clamp(GlobalWeight(evidence), target.weight / kMaxChange,
                             target.weight * kMaxChange);
  target.weights =
      LocalWeights(domain.rings, std::move(evidence), target.weight);
  return target;
}

}  // namespace colmap_ext
