#include "meshing/singular_vertices.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/indices.h"

namespace colmap_ext {
namespace {

using Cells = std::vector<uint32_t>;

// The cells of all components of the kept one's label but that one.
Cells CellsOfOthers(const VertexStar& star, size_t kept) {
  Cells cells;
  for (size_t i = 0; i < star.NumComponents(); ++i) {
    if (i != kept && star.is_free[i] == star.is_free[kept]) {
      Append(star.Component(i), &cells);
    }
  }
  return cells;
}

// Sorts cells to flip and removes those that are there twice: they are as they
// were.
void RemovePairs(Cells* cells) {
  std::ranges::sort(*cells);
  size_t size = 0;
  for (const uint32_t cell : *cells) {
    if (size > 0 && (*cells)[size - 1] == cell) {
      --size;
    } else {
      (*cells)[size++] = cell;
    }
  }
  cells->resize(size);
}

// All flips that BestFlip chooses from, sorted cells each.
std::vector<Cells> Candidates(const Tetrahedralization& tetrahedra,
                              uint32_t vertex,
                              const std::vector<uint8_t>& is_free) {
  StarGraph graph;
  MakeStarGraph(tetrahedra, vertex, &graph);
  VertexStar star;
  MakeVertexStar(graph, CellLabels(is_free), &star);
  std::vector<Cells> candidates;
  if (!star.IsSingular()) {
    return candidates;
  }
  const auto add = [&](Cells cells) {
    RemovePairs(&cells);
    if (std::ranges::find(candidates, cells) == candidates.end()) {
      candidates.push_back(std::move(cells));
    }
  };
  VertexStar once_flipped;
  for (size_t first = 0; first < star.NumComponents(); ++first) {
    const auto component = star.Component(first);
    add(Cells(component.begin(), component.end()));
    Cells others = CellsOfOthers(star, first);
    RemovePairs(&others);
    MakeVertexStar(graph, CellLabels(is_free, others), &once_flipped);
    for (size_t second = 0; second < once_flipped.NumComponents(); ++second) {
      if (once_flipped.is_free[second] != star.is_free[first]) {
        Cells cells = CellsOfOthers(once_flipped, second);
        Append(others, &cells);
        add(std::move(cells));
      }
    }
  }
  return candidates;
}

// The finite vertices of the cells, without repeats.
std::vector<uint32_t> VerticesOf(const Tetrahedralization& tetrahedra,
                                 const Cells& cells) {
  std::vector<uint32_t> vertices;
  for (const uint32_t cell : cells) {
    for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
      if (vertex != kInfiniteVertex) {
        vertices.push_back(vertex);
      }
    }
  }
  SortUnique(&vertices);
  return vertices;
}

// Components beyond the second around a vertex.
int64_t ExcessOf(const StarGraph& graph, const CellLabels& labels) {
  return std::max<int64_t>(
      0, static_cast<int64_t>(CountComponents(graph, labels)) - 2);
}

// The part of the cut's value that depends on the labels of the cells.
// \pre cells on both sides of a facet have one label, so that no facet counts
//      twice. Cells to flip do: a facet between them contains their common
//      vertex, and they are of one component.
int64_t EnergyAround(const Tetrahedralization& tetrahedra,
                     const FlowCapacities& graph, const CellLabels& labels,
                     const Cells& cells) {
  int64_t energy = 0;
  for (const uint32_t cell : cells) {
    const bool is_free = labels[cell] != 0;
    energy += is_free ? graph[cell].sink : graph[cell].source;
    for (int i = 0; i < 4; ++i) {
      const uint32_t other = tetrahedra.cells[cell].neighbors[i];
      const bool is_other_free = labels[other] != 0;
      if (is_free && !is_other_free) {
        energy += graph[cell].arcs[i];
      } else if (!is_free && is_other_free) {
        energy += graph[other].arcs[tetrahedra.FacetTo(other, cell)];
      }
    }
  }
  return energy;
}

// Cells to flip, and their place among all candidates.
struct Candidate {
  Cells cells;
  std::vector<uint32_t> vertices;  // those that may be singular first
  FlipChange change;               // first: what it cannot be below
  size_t place = 0;

  // Whether it is the better one, as far as its change is known.
  bool IsBefore(const Candidate& other) const {
    return std::tie(change, place) < std::tie(other.change, other.place);
  }
};

// Rates the flips around one vertex.
class FlipRater {
 public:
  FlipRater(const Tetrahedralization& tetrahedra, const FlowCapacities& graph,
            const std::vector<uint8_t>& is_free, const IsRegular& is_regular)
      : tetrahedra_(tetrahedra),
        graph_(graph),
        is_free_(is_free),
        is_regular_(is_regular) {}

  // With the very change of the energy, and an excess of nothing afterwards.
  Candidate Bound(Cells cells, size_t place) {
    Candidate candidate{std::move(cells), {}, {}, place};
    candidate.vertices = VerticesOf(tetrahedra_, candidate.cells);
    const auto regular = std::stable_partition(
        candidate.vertices.begin(), candidate.vertices.end(),
        [this](uint32_t vertex) { return !is_regular_(vertex); });
    const CellLabels before(is_free_);
    const CellLabels after(is_free_, candidate.cells);
    for (auto at = candidate.vertices.begin(); at != regular; ++at) {
      candidate.change.excess -= ExcessOf(GraphAt(*at), before);
    }
    candidate.change.energy =
        EnergyAround(tetrahedra_, graph_, after, candidate.cells) -
        EnergyAround(tetrahedra_, graph_, before, candidate.cells);
    return candidate;
  }

  // Adds what the vertices do afterwards, until the best one so far is better.
  void Rate(const Candidate& best, Candidate* candidate) {
    const CellLabels labels(is_free_, candidate->cells);
    for (const uint32_t vertex : candidate->vertices) {
      if (best.IsBefore(*candidate)) {
        return;
      }
      candidate->change.excess += ExcessOf(GraphAt(vertex), labels);
    }
  }

 private:
  // All flips share it, and so it is made once.
  const StarGraph& GraphAt(uint32_t vertex) {
    const auto [entry, is_new] = graphs_.try_emplace(vertex);
    if (is_new) {
      MakeStarGraph(tetrahedra_, vertex, &entry->second);
    }
    return entry->second;
  }

  const Tetrahedralization& tetrahedra_;
  const FlowCapacities& graph_;
  const std::vector<uint8_t>& is_free_;
  const IsRegular& is_regular_;
  std::unordered_map<uint32_t, StarGraph> graphs_;  // of vertices
};

}  // namespace

std::vector<uint32_t> BestFlip(const Tetrahedralization& tetrahedra,
                               const FlowCapacities& graph, uint32_t vertex,
                               int64_t max_excess,
                               const std::vector<uint8_t>& is_free,
                               const IsRegular& is_regular) {
  FlipRater rater(tetrahedra, graph, is_free, is_regular);
  std::vector<Candidate> candidates;
  for (Cells& cells : Candidates(tetrahedra, vertex, is_free)) {
    candidates.push_back(rater.Bound(std::move(cells), candidates.size()));
  }
  // Small ones first: their ratings, which need the stars of few vertices,
  // often show that larger ones are no better.
  std::ranges::stable_sort(candidates, {}, [](const Candidate& candidate) {
    return candidate.vertices.size();
  });
  Candidate best;
  best.change = {max_excess + 1, std::numeric_limits<int64_t>::min()};
  for (Candidate& candidate : candidates) {
    rater.Rate(best, &candidate);
    if (candidate.IsBefore(best)) {
      best = std::move(candidate);
    }
  }
  return best.cells;
}

}  // namespace colmap_ext
