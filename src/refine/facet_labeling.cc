#include "refine/facet_labeling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/singular_vertices.h"
#include "optim/potts_mrf.h"
#include "refine/facet_frames.h"

namespace colmap_ext {

namespace {

struct Candidate {
  uint32_t label = 0;
  float cost = 0;
};

// The pairs that each view is the first of: [views + 1] into pairs, which are
// ascending.
std::vector<uint32_t> FirstPairs(const std::vector<ViewPair>& pairs,
                                 size_t num_views) {
  std::vector<uint32_t> offsets(num_views + 1, 0);
  for (const ViewPair& pair : pairs) {
    ++offsets[pair.first + 1];
  }
  for (size_t i = 0; i < num_views; ++i) {
    offsets[i + 1] += offsets[i];
  }
  return offsets;
}

// How well view j, beside view i, can tell where a facet lies: its pixels in i
// times the squared disparity, in px of j, as it moves along its normal, both
// for a facet of unit area and a motion of unit length.
double Information(const FacetFrame& frame, const View& i, const View& j) {
  const Eigen::Vector3d ray = frame.corner - i.Center();
  const double distance = frame.normal.dot(ray);
  const double depth = i.CamFromWorld(frame.corner).z();
  const double pixels =
      std::abs(distance) / ray.norm() * i.fx * i.fy / (depth * depth);
  const Eigen::Vector3d in_j = j.CamFromWorld(frame.corner);
  const Eigen::Vector3d ray_in_j = j.cam_from_world_rotation * ray;
  const Eigen::Vector2d disparity =
      Eigen::Vector2d(
          j.fx * (ray_in_j.x() - ray_in_j.z() * in_j.x() / in_j.z()),
          j.fy * (ray_in_j.y() - ray_in_j.z() * in_j.y() / in_j.z())) /
      (in_j.z() * distance);
  return pixels * disparity.squaredNorm();
}

// Ascending labels.
class CandidateFinder {
 public:
  CandidateFinder(const TriangleMesh& mesh, const VertexAttributes& attributes,
                  const std::vector<ViewPair>& pairs,
                  const FacetVisibility& visibility,
                  const std::vector<View>& views, PairSelection selection)
      : selection_(selection),
        mesh_(mesh),
        views_(views),
        attributes_(attributes),
        pairs_(pairs),
        visibility_(visibility) {
    uint32_t num_views = 0;
    for (const ViewPair& pair : pairs) {
      num_views = std::max(num_views, pair.second + 1);
    }
    first_pairs_ = FirstPairs(pairs, num_views);
  }

  std::vector<Candidate> Find(size_t facet) const {
    const auto seen = visibility_.Views(facet);
    // Occurrences in nu_f of the views that see the facet.
    std::vector<uint32_t> counts(seen.size(), 0);
    size_t num_views = 0;  // |nu_f|
    for (const uint32_t vertex : mesh_.facets[facet]) {
      const auto views = attributes_.Views(vertex);
      num_views += views.size();
      for (const uint32_t view : views) {
        const auto at = std::lower_bound(seen.begin(), seen.end(), view);
        if (at != seen.end() && *at == view) {
          ++counts[at - seen.begin()];
        }
      }
    }
    std::vector<Candidate> candidates;
    std::vector<Candidate> others;  // that nu_f does not have
    for (size_t i = 0; i < seen.size(); ++i) {
      if (seen[i] + 1 >= first_pairs_.size()) {
        break;
      }
      size_t j = i + 1;
      for (uint32_t pair = first_pairs_[seen[i]];
           pair < first_pairs_[seen[i] + 1]; ++pair) {
        while (j < seen.size() && seen[j] < pairs_[pair].second) {
          ++j;
        }
        if (j == seen.size()) {
          break;
        }
        if (seen[j] != pairs_[pair].second) {
          continue;
        }
        if (selection_ == PairSelection::kFacetwise && counts[i] > 0 &&
            counts[j] > 0) {
          const double share = static_cast<double>(counts[i] + counts[j]) /
                               static_cast<double>(num_views);
          candidates.push_back({pair, static_cast<float>(-std::log(share))});
        } else {
          others.push_back({pair, 0});
        }
      }
    }
    if (candidates.empty()) {
      candidates = std::move(others);
    }
    AddInformation(facet, &candidates);
    return candidates;
  }

 private:
  void AddInformation(size_t facet, std::vector<Candidate>* candidates) const {
    const FacetFrame frame = ComputeFacetFrame(mesh_, mesh_.facets[facet]);
    std::vector<double> information;
    double most = 0;
    for (const Candidate& candidate : *candidates) {
      const auto& [a, b] = pairs_[candidate.label];
      information.push_back(Information(frame, views_[a], views_[b]) +
                            Information(frame, views_[b], views_[a]));
      most = std::max(most, information.back());
    }
    for (size_t i = 0; i < candidates->size(); ++i) {
      // Cameras at one place tell nothing: a small share instead of none.
      const double share = most > 0 ? information[i] / most : 1;
      (*candidates)[i].cost -=
          static_cast<float>(0.5 * std::log(std::max(share, 1e-6)));
    }
  }

  PairSelection selection_;
  const TriangleMesh& mesh_;
  const std::vector<View>& views_;
  const VertexAttributes& attributes_;
  const std::vector<ViewPair>& pairs_;
  const FacetVisibility& visibility_;
  std::vector<uint32_t> first_pairs_;
};

std::vector<std::array<uint32_t, 3>> FacetNeighbors(
    const std::vector<Facet>& facets) {
  const std::vector<uint32_t> partners = PairHalfEdges(facets);
  std::vector<std::array<uint32_t, 3>> neighbors(facets.size());
  for (size_t i = 0; i < facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t partner = partners[3 * i + k];
      const uint32_t neighbor =
          partner == kNoPartner ? UINT32_MAX : partner / 3;
      // Two facets can share two edges.
      const auto end = neighbors[i].begin() + k;
      const bool is_new = std::find(neighbors[i].begin(), end, neighbor) == end;
      neighbors[i][k] = is_new ? neighbor : UINT32_MAX;
    }
  }
  return neighbors;
}

// Candidates are found twice, to be counted and to be written: there are many.
PottsProblem MakeProblem(const CandidateFinder& finder,
                         const TriangleMesh& mesh, double weight) {
  PottsProblem problem;
  const size_t num_facets = mesh.facets.size();
  problem.offsets.assign(num_facets + 1, 0);
  tbb::parallel_for(size_t{0}, num_facets, [&](size_t i) {
    problem.offsets[i + 1] = finder.Find(i).size();
  });
  for (size_t i = 0; i < num_facets; ++i) {
    problem.offsets[i + 1] += problem.offsets[i];
  }
  problem.labels.resize(problem.offsets.back());
  problem.costs.resize(problem.offsets.back());
  tbb::parallel_for(size_t{0}, num_facets, [&](size_t i) {
    uint64_t at = problem.offsets[i];
    for (const Candidate& candidate : finder.Find(i)) {
      problem.labels[at] = candidate.label;
      problem.costs[at] = candidate.cost;
      ++at;
    }
  });
  problem.neighbors = FacetNeighbors(mesh.facets);
  problem.weight = weight;
  return problem;
}

// The chosen label of each facet, and the cheapest ones after it.
FacetLabels BestLabels(const std::vector<ViewPair>& pairs,
                       const PottsProblem& problem,
                       const std::vector<uint32_t>& choices, size_t count) {
  FacetLabels labels;
  labels.pairs = pairs;
  std::vector<uint64_t> row;  // into the problem's labels
  for (size_t i = 0; i < choices.size(); ++i) {
    row.clear();
    for (uint64_t at = problem.offsets[i]; at < problem.offsets[i + 1]; ++at) {
      row.push_back(at);
    }
    if (!row.empty()) {
      std::swap(row[0], row[choices[i]]);
      std::sort(row.begin() + 1, row.end(), [&](uint64_t a, uint64_t b) {
        return std::pair(problem.costs[a], a) < std::pair(problem.costs[b], b);
      });
      row.resize(std::min(row.size(), count));
    }
    for (const uint64_t at : row) {
      labels.labels.push_back(problem.labels[at]);
    }
    labels.offsets.push_back(labels.labels.size());
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
  PottsProblem problem = MakeProblem(
      {mesh, attributes, pairs, visibility, views, options.pair_selection},
      mesh, options.potts_weight);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    labeling.num_unlabeled_facets +=
        problem.offsets[i] == problem.offsets[i + 1] ? 1 : 0;
  }
  if (options.pair_selection == PairSelection::kClassical) {
    labeling.labels = {pairs, std::move(problem.offsets),
                       std::move(problem.labels)};
    return labeling;
  }
  const PottsSolution solution = SolvePotts(problem);
  labeling.initial_energy = solution.initial_energy;
  labeling.final_energy = solution.energy;
  labeling.lower_bound = solution.lower_bound;
  labeling.labels =
      BestLabels(pairs, problem, solution.choices, options.pairs_per_facet);
  return labeling;
}

}  // namespace colmap_ext
