#include "meshing/best_flip.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <utility>

#include "meshing/vertex_star.h"

namespace colmap_ext {
namespace {

using Cells = std::vector<uint32_t>;

void Flip(const Cells& cells, std::vector<uint8_t>* is_free) {
  for (const uint32_t cell : cells) {
    (*is_free)[cell] = !(*is_free)[cell];
  }
}

// The cells of all components of the kept one's label but that one.
Cells CellsOfOthers(const VertexStar& star, size_t kept) {
  Cells cells;
  for (size_t i = 0; i < star.NumComponents(); ++i) {
    if (i != kept && star.is_free[i] == star.is_free[kept]) {
      const auto component = star.Component(i);
      cells.insert(cells.end(), component.begin(), component.end());
    }
  }
  return cells;
}

// Sorts cells to flip and removes those that are there twice: they are as they
// were.
void RemovePairs(Cells* cells) {
  std::sort(cells->begin(), cells->end());
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
                              uint32_t vertex, std::vector<uint8_t>* is_free) {
  VertexStar star;
  MakeVertexStar(tetrahedra, *is_free, vertex, &star);
  std::vector<Cells> candidates;
  if (!star.IsSingular()) {
    return candidates;
  }
  const auto add = [&](Cells cells) {
    RemovePairs(&cells);
    if (std::find(candidates.begin(), candidates.end(), cells) ==
        candidates.end()) {
      candidates.push_back(std::move(cells));
    }
  };
  VertexStar once_flipped;
  for (size_t first = 0; first < star.NumComponents(); ++first) {
    const auto component = star.Component(first);
    add(Cells(component.begin(), component.end()));
    const Cells others = CellsOfOthers(star, first);
    Flip(others, is_free);
    MakeVertexStar(tetrahedra, *is_free, vertex, &once_flipped);
    Flip(others, is_free);
    for (size_t second = 0; second < once_flipped.NumComponents(); ++second) {
      if (once_flipped.is_free[second] != star.is_free[first]) {
        Cells cells = CellsOfOthers(once_flipped, second);
        cells.insert(cells.end(), others.begin(), others.end());
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
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// Components beyond the second around a vertex.
int64_t ExcessOf(const StarGraph& graph, const std::vector<uint8_t>& is_free) {
  return std::max<int64_t>(
      0, static_cast<int64_t>(CountComponents(graph, is_free)) - 2);
}

// The part of the cut's value that depends on the labels of the cells.
// \pre cells on both sides of a facet have one label, so that no facet counts
//      twice. Cells to flip do: a facet between them contains their common
//      vertex, and they are of one component.
int64_t EnergyAround(const Tetrahedralization& tetrahedra,
                     const FlowCapacities& graph,
                     const std::vector<uint8_t>& is_free, const Cells& cells) {
  int64_t energy = 0;
  for (const uint32_t cell : cells) {
    energy += is_free[cell] ? graph.sink[cell] : graph.source[cell];
    for (int i = 0; i < 4; ++i) {
      const uint32_t other = tetrahedra.cells[cell].neighbors[i];
      if (is_free[cell] && !is_free[other]) {
        energy += graph.capacities[cell][i];
      } else if (!is_free[cell] && is_free[other]) {
        energy += graph.capacities[other][tetrahedra.FacetTo(other, cell)];
      }
    }
  }
  return energy;
}

// Chooses among the flips around one vertex.
class FlipChooser {
 public:
  FlipChooser(const Tetrahedralization& tetrahedra, const FlowCapacities& graph,
              int64_t max_excess, std::vector<uint8_t>* is_free)
      : tetrahedra_(tetrahedra),
        graph_(graph),
        is_free_(is_free),
        best_change_{max_excess + 1, std::numeric_limits<int64_t>::min()} {}

  // Keeps the cells where their flip is better than the best one so far.
  void Offer(Cells cells) {
    const std::vector<uint32_t> vertices = VerticesOf(tetrahedra_, cells);
    FlipChange change;
    for (const uint32_t vertex : vertices) {
      change.excess -= At(vertex).excess;
    }
    change.energy = -EnergyAround(tetrahedra_, graph_, *is_free_, cells);
    Flip(cells, is_free_);
    // What the vertices add is not negative: no need to see all of them.
    for (size_t i = 0;
         i < vertices.size() && change.excess <= best_change_.excess; ++i) {
      change.excess += ExcessOf(At(vertices[i]).graph, *is_free_);
    }
    change.energy += EnergyAround(tetrahedra_, graph_, *is_free_, cells);
    Flip(cells, is_free_);
    if (change < best_change_) {
      best_change_ = change;
      best_cells_ = std::move(cells);
    }
  }

  const Cells& best_cells() const { return best_cells_; }

 private:
  // What all flips share at a vertex, and so is computed once.
  struct Surroundings {
    StarGraph graph;
    int64_t excess = 0;  // before a flip
  };

  // \pre no cells are flipped when it is called for the first time
  const Surroundings& At(uint32_t vertex) {
    const auto [entry, is_new] = surroundings_.try_emplace(vertex);
    Surroundings& surroundings = entry->second;
    if (is_new) {
      MakeStarGraph(tetrahedra_, vertex, &surroundings.graph);
      surroundings.excess = ExcessOf(surroundings.graph, *is_free_);
    }
    return surroundings;
  }

  const Tetrahedralization& tetrahedra_;
  const FlowCapacities& graph_;
  std::vector<uint8_t>* is_free_;
  FlipChange best_change_;
  Cells best_cells_;
  std::unordered_map<uint32_t, Surroundings> surroundings_;  // of vertices
};

}  // namespace

std::vector<uint32_t> BestFlip(const Tetrahedralization& tetrahedra,
                               const FlowCapacities& graph, uint32_t vertex,
                               int64_t max_excess,
                               std::vector<uint8_t>* is_free) {
  FlipChooser chooser(tetrahedra, graph, max_excess, is_free);
  for (Cells& cells : Candidates(tetrahedra, vertex, is_free)) {
    chooser.Offer(std::move(cells));
  }
  return chooser.best_cells();
}

}  // namespace colmap_ext
