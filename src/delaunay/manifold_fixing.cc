#include "delaunay/manifold_fixing.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "delaunay/vertex_star.h"

namespace colmap_ext {
namespace {

using Component = VertexStar::Component;

// Passes of the energy rule end by themselves, since each removes singular
// vertices; this bounds how many centroid splits are tried in a row.
constexpr int kMaxSplitRounds = 4;

class Fixer {
 public:
  Fixer(FixingRule rule, Tetrahedralization* tetrahedra, FlowGraph* graph,
        std::vector<uint8_t>* is_free)
      : rule_(rule),
        tetrahedra_(tetrahedra),
        graph_(graph),
        is_free_(is_free) {}

  FixingReport Run() {
    std::vector<uint32_t> singular = Singular();
    report_.num_singular_raw = singular.size();
    const int max_rounds = rule_ == FixingRule::kPaper ? 1 : kMaxSplitRounds;
    singular = RelabelAll(std::move(singular));
    for (int round = 0; round < max_rounds && !singular.empty(); ++round) {
      for (const uint32_t vertex : singular) {
        SplitSmallComponents(vertex);
      }
      const size_t before = singular.size();
      singular = RelabelAll(std::move(singular));
      if (singular.size() >= before) {
        break;
      }
    }
    report_.num_singular_fixed = singular.size();
    return report_;
  }

 private:
  std::vector<uint32_t> Singular() const {
    return SingularVertices(*tetrahedra_, *is_free_);
  }

  // \return the vertices that are singular afterwards
  std::vector<uint32_t> RelabelAll(std::vector<uint32_t> singular) {
    if (rule_ == FixingRule::kPaper) {
      for (const uint32_t vertex : singular) {
        KeepLargest(vertex, /*is_free=*/false);
        KeepLargest(vertex, /*is_free=*/true);
      }
      return Singular();
    }
    for (;;) {
      const size_t before = singular.size();
      for (const uint32_t vertex : singular) {
        RelabelByEnergy(vertex);
      }
      singular = Singular();
      if (singular.size() >= before) {
        return singular;
      }
    }
  }

  static const Component* Largest(const VertexStar& star, bool is_free) {
    const Component* largest = nullptr;
    for (const Component& component : star.components) {
      if (component.is_free == is_free &&
          (largest == nullptr ||
           component.cells.size() > largest->cells.size())) {
        largest = &component;
      }
    }
    return largest;
  }

  // The paper's rule: of the components of one label the largest stays.
  void KeepLargest(uint32_t vertex, bool is_free) {
    MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
    if (star_.IsSingular()) {
      const Component* largest = Largest(star_, is_free);
      KeepOnly(star_, largest, &flipped_);
      report_.num_relabeled_cells += flipped_.size();
      flipped_.clear();
    }
  }

  // Flips all components of the kept one's label but that one.
  void KeepOnly(const VertexStar& star, const Component* kept,
                std::vector<uint32_t>* flipped) {
    for (const Component& component : star.components) {
      if (&component != kept && component.is_free == kept->is_free) {
        for (const uint32_t cell : component.cells) {
          (*is_free_)[cell] = !component.is_free;
          flipped->push_back(cell);
        }
      }
    }
  }

  // A way to make a vertex regular: of the components of one label only `first`
  // stays; of those of the other label, as they are then, only `second`.
  struct Way {
    size_t first = 0;   // index into the star's components
    size_t second = 0;  // the how-manieth of the other label
  };

  // Tries all ways and takes the best, if it is any good.
  void RelabelByEnergy(uint32_t vertex) {
    MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
    if (!star_.IsSingular()) {
      return;
    }
    using Merit = std::tuple<int64_t, int64_t>;  // singular vertices, energy
    Merit best{0, std::numeric_limits<int64_t>::min()};
    Way best_way;
    const VertexStar star = star_;
    for (Way way; way.first < star.components.size(); ++way.first) {
      for (way.second = 0;; ++way.second) {
        if (!Take(vertex, star, way)) {
          break;
        }
        const Merit merit = MeritOf(flipped_);
        Flip(flipped_);
        if (merit < best) {
          best = merit;
          best_way = way;
        }
      }
    }
    if (std::get<0>(best) < 0) {
      Take(vertex, star, best_way);
      report_.num_relabeled_cells += flipped_.size();
    }
  }

  // Relabels cells the given way and notes them in flipped_.
  // \return false where there is no such way; nothing is relabeled then.
  bool Take(uint32_t vertex, const VertexStar& star, const Way& way) {
    flipped_.clear();
    const Component& first = star.components[way.first];
    KeepOnly(star, &first, &flipped_);
    MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
    size_t count = 0;
    for (const Component& component : star_.components) {
      if (component.is_free != first.is_free && count++ == way.second) {
        KeepOnly(star_, &component, &flipped_);
        // A cell that was flipped twice is as it was.
        std::sort(flipped_.begin(), flipped_.end());
        RemovePairs(&flipped_);
        return true;
      }
    }
    Flip(flipped_);
    return false;
  }

  static void RemovePairs(std::vector<uint32_t>* sorted) {
    size_t size = 0;
    for (const uint32_t cell : *sorted) {
      if (size > 0 && (*sorted)[size - 1] == cell) {
        --size;
      } else {
        (*sorted)[size++] = cell;
      }
    }
    sorted->resize(size);
  }

  void Flip(const std::vector<uint32_t>& cells) {
    for (const uint32_t cell : cells) {
      (*is_free_)[cell] = !(*is_free_)[cell];
    }
  }

  // How the flip of these cells, which has been done, changed the number of
  // singular vertices and the energy.
  std::tuple<int64_t, int64_t> MeritOf(const std::vector<uint32_t>& flipped) {
    std::vector<uint32_t> vertices;
    for (const uint32_t cell : flipped) {
      for (const uint32_t vertex : tetrahedra_->cells[cell].vertices) {
        if (vertex != kInfiniteVertex) {
          vertices.push_back(vertex);
        }
      }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()),
                   vertices.end());
    const auto count = [&] {
      return std::count_if(vertices.begin(), vertices.end(),
                           [&](uint32_t vertex) {
                             return IsSingular(*tetrahedra_, *is_free_, vertex);
                           });
    };
    const int64_t singular_after = count();
    const int64_t energy_after = EnergyAround(flipped);
    Flip(flipped);
    const int64_t singular_before = count();
    const int64_t energy_before = EnergyAround(flipped);
    Flip(flipped);
    return {singular_after - singular_before, energy_after - energy_before};
  }

  // The part of the cut's value that depends on the labels of these cells.
  // \param cells sorted
  int64_t EnergyAround(const std::vector<uint32_t>& cells) const {
    int64_t energy = 0;
    for (const uint32_t index : cells) {
      const bool is_free = (*is_free_)[index];
      energy += is_free ? graph_->sink[index] : graph_->source[index];
      for (int i = 0; i < 4; ++i) {
        const uint32_t other = graph_->neighbors[index][i];
        if (is_free == static_cast<bool>((*is_free_)[other])) {
          continue;
        }
        if (is_free) {
          energy += graph_->capacities[index][i];
        } else if (!std::binary_search(cells.begin(), cells.end(), other)) {
          energy +=
              graph_->capacities[other][tetrahedra_->FacetTo(other, index)];
        }
      }
    }
    return energy;
  }

  // Splits every cell of every component but the largest of either label.
  void SplitSmallComponents(uint32_t vertex) {
    MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
    if (!star_.IsSingular()) {
      return;
    }
    const Component* largest_free = Largest(star_, true);
    const Component* largest_matter = Largest(star_, false);
    for (const Component& component : star_.components) {
      if (&component == largest_free || &component == largest_matter) {
        continue;
      }
      for (const uint32_t cell : component.cells) {
        if (!tetrahedra_->IsInfinite(cell)) {
          SplitCell(cell, tetrahedra_, graph_, is_free_);
          ++report_.num_split_cells;
        }
      }
    }
  }

  const FixingRule rule_;
  Tetrahedralization* tetrahedra_;
  FlowGraph* graph_;
  std::vector<uint8_t>* is_free_;
  FixingReport report_;
  VertexStar star_;
  std::vector<uint32_t> flipped_;
};

}  // namespace

void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra, FlowGraph* graph,
               std::vector<uint8_t>* is_free) {
  const Tetrahedralization::Cell parent = tetrahedra->cells[cell];
  const auto first_new = static_cast<uint32_t>(tetrahedra->cells.size());
  const std::array<uint32_t, 4> children = {cell, first_new, first_new + 1,
                                            first_new + 2};
  const auto centroid = static_cast<uint32_t>(tetrahedra->points.size());
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (const uint32_t vertex : parent.vertices) {
    position += 0.25 * tetrahedra->points[vertex].cast<double>();
  }
  tetrahedra->points.push_back(position.cast<float>());
  tetrahedra->vertex_cells.push_back(cell);
  tetrahedra->cells.resize(first_new + 3);
  graph->neighbors.resize(first_new + 3);
  graph->capacities.resize(first_new + 3);
  graph->source.resize(first_new + 3, graph->source[cell] / 4);
  graph->sink.resize(first_new + 3, graph->sink[cell] / 4);
  graph->source[cell] -= 3 * (graph->source[cell] / 4);
  graph->sink[cell] -= 3 * (graph->sink[cell] / 4);
  is_free->resize(first_new + 3, (*is_free)[cell]);
  const std::array<uint32_t, 4> capacities = graph->capacities[cell];
  for (int i = 0; i < 4; ++i) {
    // The child that has the centroid in place of the parent's vertex i.
    Tetrahedralization::Cell child{parent.vertices, children};
    child.vertices[i] = centroid;
    child.neighbors[i] = parent.neighbors[i];
    tetrahedra->cells[children[i]] = child;
    graph->neighbors[children[i]] = child.neighbors;
    graph->capacities[children[i]] = {0, 0, 0, 0};
    graph->capacities[children[i]][i] = capacities[i];
    const uint32_t outer = parent.neighbors[i];
    const int back = tetrahedra->FacetTo(outer, cell);
    tetrahedra->cells[outer].neighbors[back] = children[i];
    graph->neighbors[outer][back] = children[i];
    tetrahedra->vertex_cells[parent.vertices[i]] = children[(i + 1) % 4];
  }
}

FixingReport FixSingularVertices(FixingRule rule,
                                 Tetrahedralization* tetrahedra,
                                 FlowGraph* graph,
                                 std::vector<uint8_t>* is_free) {
  return Fixer(rule, tetrahedra, graph, is_free).Run();
}

}  // namespace colmap_ext
