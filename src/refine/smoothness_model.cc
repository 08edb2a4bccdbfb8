#include "refine/smoothness_model.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "base/percentile.h"
#include "mesh/confidences.h"
#include "mesh/normals.h"
#include "refine/vertex_motion.h"

namespace colmap_ext {
namespace {

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Over the views of the best pairs around a vertex that it lies before; 0 if
// there are none.
float MeanFootprint(const Eigen::Vector3d& point,
                    std::span<const uint32_t> corners,
                    const FacetLabels& labels, const std::vector<View>& views) {
  double sum = 0;
  int count = 0;
  for (const uint32_t corner : corners) {
    const auto row = labels.labels[corner / 3];
    if (row.empty()) {
      continue;
    }
    const ViewPair& pair = labels.pairs[row.front()];
    for (const uint32_t view : {pair.first, pair.second}) {
      const double depth = views[view].CamFromWorld(point).z();
      if (depth > 0) {
        sum += depth / views[view].fx;
        ++count;
      }
    }
  }
  return count > 0 ? static_cast<float>(sum / count) : 0;
}

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
  for (uint32_t i = 0; i < roughness.size(); ++i) {
    const double with = model.plate.residuals[i];
    const double without = domain.is_seen[i] != 0 ? own[i] : with;
    roughness[i] = IsFixed(domain.fixed, i)
                       ? 0
                       : roughness[i] * (with * with + without * without) / 2;
  }
  return roughness;
}

}  // namespace

void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values) {
  // A round spreads a value by 6/7 edge^2, over two axes. Enough that the noise
  // of a vertex averages out over dozens of others.
  constexpr int kRounds = 10;
  AverageOverNeighbors(rings.neighbors, kRounds, values);
}

double GlobalWeight(const SmoothnessEvidence& evidence) {
  const double roughness = Sum(evidence.roughness);
  return roughness > 0 ? std::max(Sum(evidence.determined), 0.0) / roughness
                       : std::numeric_limits<double>::infinity();
}

std::vector<double> LocalWeights(const VertexRings& rings,
                                 SmoothnessEvidence evidence, double weight) {
  // The global weight counts as this share of the mean evidence of a vertex.
  constexpr double kPrior = 0.002;
  // Of the global weight. These and kEvidenceRounds were found by trial;
  // tests/benchmarks/vary_constants.py tables what other values do.
  constexpr double kMinFactor = 0.7;
  constexpr double kMaxFactor = 256;
  constexpr int kEvidenceRounds = 4;
  std::vector<double> weights(evidence.determined.size(), weight);
  const auto num_residuals = static_cast<double>(
      std::count_if(evidence.determined.begin(), evidence.determined.end(),
                    [](double determined) { return determined != 0; }));
  const double prior = kPrior * Sum(evidence.determined) / num_residuals;
  if (!(prior > 0)) {
    return weights;
  }
  AverageOverNeighbors(rings.neighbors, kEvidenceRounds, &evidence.determined);
  AverageOverNeighbors(rings.neighbors, kEvidenceRounds, &evidence.roughness);
  for (size_t i = 0; i < weights.size(); ++i) {
    const double local = (std::max(evidence.determined[i], 0.0) + prior) /
                         (evidence.roughness[i] + prior / weight);
    weights[i] = std::clamp(local, kMinFactor * weight, kMaxFactor * weight);
  }
  return weights;
}

std::vector<float> VertexFootprints(const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const FacetLabels& labels,
                                    const std::vector<View>& views) {
  std::vector<float> footprints(mesh.vertices.size());
  std::vector<float> known;
  for (size_t i = 0; i < footprints.size(); ++i) {
    footprints[i] = MeanFootprint(mesh.vertices[i].cast<double>(),
                                  rings.corners[i], labels, views);
    if (footprints[i] > 0) {
      known.push_back(footprints[i]);
    }
  }
  if (known.empty()) {
    return footprints;
  }
  std::replace_if(
      footprints.begin(), footprints.end(),
      [](float footprint) { return !(footprint > 0); }, Percentile(50, &known));
  return footprints;
}

std::vector<uint8_t> SeenVertices(const TriangleMesh& mesh,
                                  const PhotometricTerms& terms) {
  const std::vector<double> num_pixels =
      SumsAtVertices(mesh, terms.facets, &FacetTerms::num_pixels);
  std::vector<uint8_t> is_seen(num_pixels.size());
  std::ranges::transform(num_pixels, is_seen.begin(),
                         [](double count) { return count > 0; });
  return is_seen;
}

std::vector<float> PixelsOfVertices(const TriangleMesh& mesh,
                                    const PhotometricTerms& terms,
                                    const std::vector<float>& footprints) {
  std::vector<float> num_pixels(mesh.vertices.size(), 0);
  std::vector<float> areas(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const float area = AreaVector(mesh, mesh.facets[i]).norm() / 2;
    for (const uint32_t vertex : mesh.facets[i]) {
      num_pixels[vertex] += terms.facets[i].num_pixels / 3;
      areas[vertex] += area / 3;
    }
  }
  for (size_t i = 0; i < num_pixels.size(); ++i) {
    if (footprints[i] > 0) {
      num_pixels[i] =
          std::max(num_pixels[i], areas[i] / (footprints[i] * footprints[i]));
    }
  }
  return num_pixels;
}

SmoothnessTarget FirstTarget(const SmoothnessDomain& domain,
                             const TriangleMesh& mesh, double weight) {
  SmoothnessTarget target{weight,
                          std::vector<double>(mesh.vertices.size(), weight),
                          Relief(mesh, domain.rings, domain.footprints)};
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
                                 const SmoothnessModel& model, double factor) {
  // How many times the energy counts the noise of a pixel: windows overlap, and
  // both directions of several pairs compare it. Found by trial on rendered
  // scenes; rows "half" and "twice the smoothness" of docs/experiments.md show
  // what half and twice do.
  constexpr double kRedundancy = 8;
  // Factor by which the weight may change in an iteration, so that the first
  // estimates, of a rough surface, do not throw it about.
  constexpr double kMaxChange = 4;
  SmoothnessEvidence evidence{
      NormalEquations(surface, domain, model.plate).Determined(),
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
