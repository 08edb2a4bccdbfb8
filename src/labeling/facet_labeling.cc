#include "labeling/facet_labeling.h"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "mesh/adjacency.h"
#include "optim/potts_mrf.h"

namespace colmap_ext {
namespace {

// A pair of views that a facet can be refined by.
struct CandidatePair {
  uint32_t label = 0;  // index of the pair
  float cost = 0;      // negative logarithm of a share
};

// Information of view j on the facet's position, beside i: pixels in i times
// the squared motion in j (px) for a unit motion along the normal, for a facet
// of unit area (docs/method.md, section 4.3). The number of pixels is low by
// the cosine of the angle between the ray and the axis of i: exact is |n . ray|
// fx fy / z^3. 0 where the facet's corner lies behind a view.
double Information(const FacetFrame& frame, const View& i, const View& j) {
  const Eigen::Vector3d ray = frame.corner - i.Center();
  const double distance = frame.normal.dot(ray);
  const double depth = i.CamFromWorld(frame.corner).z();
  const Eigen::Vector3d in_j = j.CamFromWorld(frame.corner);
  if (!(depth > 0 && in_j.z() > 0)) {
    return 0;
  }
  const double pixels =
      std::abs(distance) / ray.norm() * i.fx * i.fy / (depth * depth);
  const Eigen::Vector3d ray_in_j = j.cam_from_world_rotation * ray;
  const Eigen::Vector2d disparity =
      Eigen::Vector2d(
          j.fx * (ray_in_j.x() - ray_in_j.z() * in_j.x() / in_j.z()),
          j.fy * (ray_in_j.y() - ray_in_j.z() * in_j.y() / in_j.z())) /
      (in_j.z() * distance);
  return pixels * disparity.squaredNorm();
}

// The pairs of views that can refine a facet, and what they cost as its label
// (docs/method.md, section 4.3).
class CandidatePairs {
 public:
  // All but the selection are kept by reference.
  // \param pairs  ascending.
  // \param views  of the images' sizes.
  CandidatePairs(const TriangleMesh& mesh, const VertexAttributes& attributes,
                 const std::vector<ViewPair>& pairs,
                 const FacetVisibility& visibility,
                 const std::vector<View>& views, PairSelection selection)
      : selection_(selection),
        mesh_(mesh),
        views_(views),
        attributes_(attributes),
        pairs_(pairs),
        visibility_(visibility),
        pairs_of_(NumbersInRows(views.size(), pairs.size(),
                                [&](uint32_t i) { return pairs[i].first; })) {}

  // Ascending labels. Costs are -log(O_f / |nu_f|). If no pair occurs in nu_f,
  // or with kClassical, all pairs that see the facet, of cost 0.
  std::vector<CandidatePair> Find(size_t facet) const {
    const Occurrences occurrences = CountOccurrences(facet);
    const std::vector<uint32_t>& counts = occurrences.counts;
    std::vector<CandidatePair> candidates;
    std::vector<CandidatePair> others;  // that nu_f does not have
    ForEachSeeing(facet, [&](uint32_t pair, size_t i, size_t j) {
      if (selection_ == PairSelection::kFacetwise && counts[i] > 0 &&
          counts[j] > 0) {
        const double share = static_cast<double>(counts[i] + counts[j]) /
                             static_cast<double>(occurrences.num_views);
        candidates.push_back({pair, static_cast<float>(-std::log(share))});
      } else {
        others.push_back({pair, 0});
      }
    });
    return candidates.empty() ? others : candidates;
  }

  // Adds -1/2 log(Q / Q_max) to the costs.
  void AddInformation(size_t facet,
                      std::vector<CandidatePair>* candidates) const {
    // Of the best pair's. Cameras at one place have no information: they
    // cost 6.9, more than any difference of the other term, instead of
    // infinitely much.
    constexpr double kMinShare = 1e-6;
    const FacetFrame frame = ComputeFacetFrame(mesh_, mesh_.facets[facet]);
    std::vector<double> information;
    double most = 0;
    for (const CandidatePair& candidate : *candidates) {
      const auto& [a, b] = pairs_[candidate.label];
      information.push_back(Information(frame, views_[a], views_[b]) +
                            Information(frame, views_[b], views_[a]));
      most = std::max(most, information.back());
    }
    for (size_t i = 0; i < candidates->size(); ++i) {
      const double share = most > 0 ? information[i] / most : 1;
      (*candidates)[i].cost -=
          static_cast<float>(0.5 * std::log(std::max(share, kMinShare)));
    }
  }

 private:
  // How often the views that see a facet occur in the lists of its vertices.
  struct Occurrences {
    size_t num_views = 0;          // |nu_f|
    std::vector<uint32_t> counts;  // of the views that see the facet
  };

  Occurrences CountOccurrences(size_t facet) const {
    const auto seen = visibility_[facet];
    Occurrences occurrences{0, std::vector<uint32_t>(seen.size(), 0)};
    for (const uint32_t vertex : mesh_.facets[facet]) {
      const auto views = attributes_.views[vertex];
      occurrences.num_views += views.size();
      for (const uint32_t view : views) {
        const auto at = std::ranges::lower_bound(seen, view);
        if (at != seen.end() && *at == view) {
          ++occurrences.counts[at - seen.begin()];
        }
      }
    }
    return occurrences;
  }

  // Calls function(pair, i, j) for each pair that sees a facet, ascending: its
  // views are the i-th and the j-th that see it.
  // The pairs of a view and the views that see the facet are both ascending:
  // one pass over both finds what they have in common.
  template <typename Function>
  void ForEachSeeing(size_t facet, const Function& function) const {
    const auto seen = visibility_[facet];
    for (size_t i = 0; i < seen.size(); ++i) {
      size_t j = i + 1;
      for (const uint32_t pair : pairs_of_[seen[i]]) {
        while (j < seen.size() && seen[j] < pairs_[pair].second) {
          ++j;
        }
        if (j < seen.size() && seen[j] == pairs_[pair].second) {
          function(pair, i, j);
        }
      }
    }
  }

  PairSelection selection_;
  const TriangleMesh& mesh_;
  const std::vector<View>& views_;
  const VertexAttributes& attributes_;
  const std::vector<ViewPair>& pairs_;
  const FacetVisibility& visibility_;
  Rows<uint32_t> pairs_of_;  // [views] that each view is the first of
};

using Neighbors = std::vector<std::array<uint32_t, 3>>;  // or kNone

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
  field.nodes.resize(order.size());
  for (uint32_t node = 0; node < order.size(); ++node) {
    field.nodes[order[node]] = node;
  }
  field.problem.neighbors.reserve(order.size());
  for (const uint32_t facet : order) {
    auto& of_node = field.problem.neighbors.emplace_back(neighbors[facet]);
    for (uint32_t& neighbor : of_node) {
      neighbor = neighbor == kNone ? kNone : field.nodes[neighbor];
    }
  }
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
  AddCandidates(candidates, Iota(num_facets), pairs.size(), &problem);
  return {pairs, {std::move(problem.offsets), std::move(problem.labels)}, {}};
}

FacetLabels BestLabels(const std::vector<ViewPair>& pairs,
                       const FacetField& field,
                       const std::vector<uint32_t>& choices,
                       const FacetLabelingOptions& options) {
  const PottsProblem& problem = field.problem;
  LabelSets sets = ChosenLabels(problem, choices);
  sets = AddFurtherLabels(problem, sets, options.pairs_per_facet);
  sets = AddFurtherLabels(
      problem, sets,
      std::max(options.pairs_per_facet, options.final_pairs_per_facet));
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
  labeling.num_pairs = pairs.size();
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
    labeling.labels = BestLabels(pairs, field, solution.choices, options);
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    labeling.num_unlabeled_facets += labeling.labels.labels[i].empty() ? 1 : 0;
  }
  return labeling;
}

}  // namespace colmap_ext
