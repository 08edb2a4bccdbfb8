#include "labeling/facet_labeling.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "labeling/candidate_pairs.h"
#include "mesh/adjacency.h"
#include "optim/further_labels.h"
#include "optim/potts_mrf.h"
#include "optim/sweep_order.h"

namespace colmap_ext {

namespace {

using Neighbors = std::vector<std::array<uint32_t, 3>>;

Neighbors FacetNeighbors(const std::vector<Facet>& facets) {
  const std::vector<uint32_t> partners = PairHalfEdges(facets);
  Neighbors neighbors(facets.size());
  for (size_t i = 0; i < facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t partner = partners[3 * i + k];
      const uint32_t neighbor = partner == kNone ? kNone : partner / 3;
      // Two facets can share two edges.
      const auto end = neighbors[i].begin() + k;
      const bool is_new = std::find(neighbors[i].begin(), end, neighbor) == end;
      neighbors[i][k] = is_new ? neighbor : kNone;
    }
  }
  return neighbors;
}

// The inverse permutation.
std::vector<uint32_t> Inverse(const std::vector<uint32_t>& order) {
  std::vector<uint32_t> inverse(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    inverse[order[i]] = i;
  }
  return inverse;
}

// Of facet order[i], in terms of nodes, for each i.
Neighbors NodeNeighbors(const Neighbors& facet_neighbors,
                        const std::vector<uint32_t>& order,
                        const std::vector<uint32_t>& node_of_facet) {
  Neighbors neighbors(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t facet = facet_neighbors[order[i]][k];
      neighbors[i][k] = facet == kNone ? facet : node_of_facet[facet];
    }
  }
  return neighbors;
}

// A facet that hundreds of images see has thousands of candidates. Tuned on:
// bunny and b_wall; by: accuracy, the same with 32 and with all, less with 16
// on b_wall.
constexpr int kMaxCandidates = 32;

// Leaves the cheapest, ascending in labels.
void KeepCheapest(size_t count, std::vector<CandidatePair>* candidates) {
  if (candidates->size() <= count) {
    return;
  }
  std::ranges::nth_element(*candidates,
                           candidates->begin() + static_cast<ptrdiff_t>(count),
                           {}, [](const CandidatePair& candidate) {
                             return std::pair(candidate.cost, candidate.label);
                           });
  candidates->resize(count);
  std::ranges::sort(*candidates, {}, &CandidatePair::label);
}

// The candidates of facet order[i] in row i, the cheapest of them where there
// are more than max_candidates. They are found twice, to be counted and to be
// written: there are many.
void AddCandidates(const CandidatePairs& candidates,
                   const std::vector<uint32_t>& order, size_t max_candidates,
                   PottsProblem* problem) {
  const size_t num_facets = order.size();
  std::vector<uint64_t>& offsets = problem->offsets;
  offsets.assign(num_facets + 1, 0);
  tbb::parallel_for(size_t{0}, num_facets, [&](size_t i) {
    offsets[i + 1] = std::min(candidates.Find(order[i]).size(), max_candidates);
  });
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  problem->labels.resize(offsets.back());
  problem->costs.resize(offsets.back());
  tbb::parallel_for(size_t{0}, num_facets, [&](size_t i) {
    std::vector<CandidatePair> row = candidates.Find(order[i]);
    candidates.AddInformation(order[i], &row);
    KeepCheapest(max_candidates, &row);
    for (size_t j = 0; j < row.size(); ++j) {
      problem->labels[offsets[i] + j] = row[j].label;
      problem->costs[offsets[i] + j] = row[j].cost;
    }
  });
}

// The facets' Markov random field.
struct FacetField {
  PottsProblem problem;         // nodes in a SweepOrder
  std::vector<uint32_t> nodes;  // [F] of each facet
};

FacetField MakeField(const CandidatePairs& candidates,
                     const std::vector<Facet>& facets,
                     const FacetLabelingOptions& options) {
  FacetField field;
  const Neighbors neighbors = FacetNeighbors(facets);
  const std::vector<uint32_t> order = SweepOrder(neighbors);
  field.nodes = Inverse(order);
  field.problem.neighbors = NodeNeighbors(neighbors, order, field.nodes);
  field.problem.weight = options.potts_weight;
  const auto max_candidates =
      static_cast<size_t>(std::max({kMaxCandidates, options.pairs_per_facet,
                                    options.final_pairs_per_facet}));
  AddCandidates(candidates, order, max_candidates, &field.problem);
  return field;
}

FacetLabels AllLabels(const CandidatePairs& candidates,
                      const std::vector<ViewPair>& pairs, size_t num_facets) {
  PottsProblem problem;
  std::vector<uint32_t> order(num_facets);
  std::iota(order.begin(), order.end(), 0);
  AddCandidates(candidates, order, pairs.size(), &problem);
  return {pairs, {std::move(problem.offsets), std::move(problem.labels)}, {}};
}

FacetLabels BestLabels(const std::vector<ViewPair>& pairs,
                       const FacetField& field,
                       const std::vector<uint32_t>& choices, uint32_t count,
                       uint32_t final_count) {
  const PottsProblem& problem = field.problem;
  LabelSets sets = ChosenLabels(problem, choices);
  sets = AddFurtherLabels(problem, sets, count);
  sets = AddFurtherLabels(problem, sets, std::max(count, final_count));
  FacetLabels labels;
  labels.pairs = pairs;
  labels.labels.Reserve(sets.size(), sets.values.size());
  for (const uint32_t node : field.nodes) {
    labels.labels.AddRow(sets[node]);
  }
  return labels;
}

}  // namespace

FacetLabeling LabelFacets(const FacetLabelingOptions& options,
                          const TriangleMesh& mesh,
                          const VertexAttributes& attributes,
                          const std::vector<ViewPair>& pairs,
                          const FacetVisibility& visibility,
                          const std::vector<View>& views) {
  FacetLabeling labeling;
  const CandidatePairs candidates(mesh, attributes, pairs, visibility, views,
                                  options.pair_selection);
  if (options.pair_selection == PairSelection::kClassical) {
    labeling.labels = AllLabels(candidates, pairs, mesh.facets.size());
  } else {
    const FacetField field = MakeField(candidates, mesh.facets, options);
    const PottsSolution solution = SolvePotts(field.problem);
    labeling.initial_energy = solution.initial_energy;
    labeling.final_energy = solution.energy;
    labeling.lower_bound = solution.lower_bound;
    labeling.labels =
        BestLabels(pairs, field, solution.choices, options.pairs_per_facet,
                   options.final_pairs_per_facet);
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    labeling.num_unlabeled_facets += labeling.labels.labels[i].empty() ? 1 : 0;
  }
  return labeling;
}

}  // namespace colmap_ext
