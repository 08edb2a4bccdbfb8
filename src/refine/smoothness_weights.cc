#include "refine/smoothness_weights.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include <tbb/parallel_for.h>

namespace colmap_ext {

void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values) {
  // A round spreads a value by 6/7 edge^2, over two axes. Large enough that the
  // noise of one vertex's evidence averages out over some ten others, small
  // enough that a plastered wall and the cornice above it stay apart.
  constexpr int kRounds = 10;
  std::vector<double> means(values->size());
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(size_t{0}, values->size(), [&](size_t i) {
      const auto ring = rings.neighbors[i];
      double sum = (*values)[i];
      for (const uint32_t neighbor : ring) {
        sum += (*values)[neighbor];
      }
      means[i] = sum / static_cast<double>(1 + ring.size());
    });
    values->swap(means);
  }
}

namespace {

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

double GlobalWeight(const SmoothnessEvidence& evidence) {
  const double roughness = Sum(evidence.roughness);
  return roughness > 0 ? std::max(Sum(evidence.determined), 0.0) / roughness
                       : std::numeric_limits<double>::infinity();
}

std::vector<double> LocalWeights(const VertexRings& rings,
                                 SmoothnessEvidence evidence, double weight) {
  // The global weight counts as much as this share of the evidence that a
  // vertex has on average.
  constexpr double kPrior = 0.1;
  // Of the global weight. Found by trial; tests/benchmarks/vary_constants.py
  // tables what other values do.
  constexpr double kMinFactor = 0.5;
  constexpr double kMaxFactor = 16;
  std::vector<double> weights(evidence.determined.size(), weight);
  const auto num_residuals = static_cast<double>(
      std::count_if(evidence.determined.begin(), evidence.determined.end(),
                    [](double determined) { return determined != 0; }));
  const double prior = kPrior * Sum(evidence.determined) / num_residuals;
  if (!(prior > 0)) {
    return weights;
  }
  AverageOverSurroundings(rings, &evidence.determined);
  AverageOverSurroundings(rings, &evidence.roughness);
  for (size_t i = 0; i < weights.size(); ++i) {
    const double local = (std::max(evidence.determined[i], 0.0) + prior) /
                         (evidence.roughness[i] + prior / weight);
    weights[i] = std::clamp(local, kMinFactor * weight, kMaxFactor * weight);
  }
  return weights;
}

}  // namespace colmap_ext
