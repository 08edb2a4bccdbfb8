#include "delaunay/manifold_fixing.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "delaunay/vertex_star.h"

namespace colmap_ext {
namespace {

using Component = VertexStar::Component;

// How often the energy rule splits what it could not fix.
constexpr int kMaxSplitRounds = 3;

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
    singular = RelabelAll(std::move(singular));
    if (rule_ == FixingRule::kPaper) {
      SplitAll(singular);
      singular = RelabelAll(std::move(singular));
    } else {
      singular = FixWhatIsLeft(std::move(singular));
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
      KeepLargest(singular);
      return Singular();
    }
    for (;;) {
      const size_t before = report_.num_relabeled_cells;
      for (const uint32_t vertex : singular) {
        RelabelByEnergy(vertex, /*max_change=*/-1);
      }
      if (report_.num_relabeled_cells == before) {
        return singular;
      }
      singular = Singular();
    }
  }

  // Where no way is better any more: splits the cells, and has the vertices
  // take a way that is no worse, or that of the paper, in the hope that the
  // next ones are better. Labels that do not come out better are put back.
  std::vector<uint32_t> FixWhatIsLeft(std::vector<uint32_t> singular) {
    for (int round = 0; round < kMaxSplitRounds && !singular.empty(); ++round) {
      SplitAll(singular);
      const std::vector<uint8_t> labels = *is_free_;
      const size_t num_relabeled = report_.num_relabeled_cells;
      for (const bool as_the_paper : {false, true}) {
        if (as_the_paper) {
          KeepLargest(singular);
        } else {
          for (const uint32_t vertex : singular) {
            RelabelByEnergy(vertex, /*max_change=*/0);
          }
        }
        std::vector<uint32_t> left = RelabelAll(Singular());
        if (left.size() < singular.size()) {
          singular = std::move(left);
          break;
        }
        *is_free_ = labels;
        report_.num_relabeled_cells = num_relabeled;
      }
    }
    return singular;
  }

  // The paper's relabeling.
  void KeepLargest(const std::vector<uint32_t>& singular) {
    for (const uint32_t vertex : singular) {
      KeepLargest(vertex, /*is_free=*/false);
      KeepLargest(vertex, /*is_free=*/true);
    }
  }

  void SplitAll(const std::vector<uint32_t>& singular) {
    for (const uint32_t vertex : singular) {
      SplitSmallComponents(vertex);
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

  // Ways to make a vertex less singular, as cells to flip: each component
  // alone, and all but one of one label, then all but one of those of the other
  // label, as they are by then.
  std::vector<std::vector<uint32_t>> Ways(uint32_t vertex) {
    MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
    std::vector<std::vector<uint32_t>> ways;
    if (!star_.IsSingular()) {
      return ways;
    }
    const VertexStar star = star_;
    for (const Component& first : star.components) {
      ways.push_back(first.cells);
      std::vector<uint32_t> flipped;
      KeepOnly(star, &first, &flipped);
      MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
      const VertexStar then = star_;
      for (const Component& second : then.components) {
        if (second.is_free != first.is_free) {
          std::vector<uint32_t> more;
          KeepOnly(then, &second, &more);
          Flip(more);
          more.insert(more.end(), flipped.begin(), flipped.end());
          ways.push_back(std::move(more));
        }
      }
      Flip(flipped);
    }
    for (std::vector<uint32_t>& way : ways) {
      // A cell that is flipped twice is as it was.
      std::sort(way.begin(), way.end());
      RemovePairs(&way);
    }
    return ways;
  }

  // Takes the best way, unless it changes the number of components too many by
  // more than max_change.
  void RelabelByEnergy(uint32_t vertex, int64_t max_change) {
    Merit best{max_change + 1, std::numeric_limits<int64_t>::min()};
    std::vector<uint32_t> best_way;
    for (std::vector<uint32_t>& way : Ways(vertex)) {
      const Merit merit = MeritOf(way);
      if (merit < best) {
        best = merit;
        best_way = std::move(way);
      }
    }
    Flip(best_way);
    report_.num_relabeled_cells += best_way.size();
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

  // How the flip of cells changes the number of components too many around
  // vertices, and the energy.
  using Merit = std::pair<int64_t, int64_t>;

  Merit MeritOf(const std::vector<uint32_t>& cells) {
    std::vector<uint32_t> vertices;
    for (const uint32_t cell : cells) {
      for (const uint32_t vertex : tetrahedra_->cells[cell].vertices) {
        if (vertex != kInfiniteVertex) {
          vertices.push_back(vertex);
        }
      }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()),
                   vertices.end());
    const Merit before{ComponentsTooMany(vertices), EnergyAround(cells)};
    Flip(cells);
    const Merit after{ComponentsTooMany(vertices), EnergyAround(cells)};
    Flip(cells);
    return {after.first - before.first, after.second - before.second};
  }

  int64_t ComponentsTooMany(const std::vector<uint32_t>& vertices) {
    int64_t count = 0;
    for (const uint32_t vertex : vertices) {
      MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
      count += std::max<int64_t>(
          0, static_cast<int64_t>(star_.components.size()) - 2);
    }
    return count;
  }

  // The part of the cut's value that depends on the labels of these cells,
  // which share a vertex: two of them side by side have one label.
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
        energy +=
            is_free
                ? graph_->capacities[index][i]
                : graph_->capacities[other][tetrahedra_->FacetTo(other, index)];
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
