#include "meshing/fix_singular_vertices.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <unordered_set>

#include <tbb/parallel_for.h>

#include "meshing/singular_vertices.h"
#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

Eigen::Vector3f Centroid(const Tetrahedralization& tetrahedra, uint32_t cell) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
    sum += 0.25 * tetrahedra.points[vertex].cast<double>();
  }
  return sum.cast<float>();
}

// How often the energy rule splits the cells around what it could not fix.
// Tuned on: fountain, 7 times side by side, 452 singular vertices; by: those
// left after 0, 1, 2 and 3 rounds: 12, 11, 11 and 9.
constexpr int kMaxSplitRounds = 3;

// Vertices whose flips are chosen side by side. More keep more threads busy,
// but more of them have to be chosen again. The result is the same.
constexpr size_t kSideBySide = 32;

// The component of a label with the most cells, the first one of equal ones.
std::optional<size_t> Largest(const VertexStar& star, bool is_free) {
  std::optional<size_t> largest;
  for (size_t i = 0; i < star.NumComponents(); ++i) {
    if ((star.is_free[i] != 0) == is_free &&
        (!largest ||
         star.Component(i).size() > star.Component(*largest).size())) {
      largest = i;
    }
  }
  return largest;
}

class Fixer {
 public:
  Fixer(Tetrahedralization* tetrahedra, FlowCapacities* graph,
        std::vector<uint8_t>* is_free, PartialComplex* partial)
      : tetrahedra_(tetrahedra),
        graph_(graph),
        is_free_(is_free),
        partial_(partial),
        tracker_(*tetrahedra, is_free,
                 partial != nullptr ? &partial->singular : nullptr) {}

  FixingReport Run(FixingRule rule) {
    report_.num_singular_raw = tracker_.Singular().size();
    if (rule == FixingRule::kPaper) {
      FixByPaper();
    } else {
      FixByEnergy();
    }
    report_.num_singular_fixed = tracker_.Singular().size();
    report_.num_relabeled_cells = tracker_.num_flips();
    report_.num_examined_vertices = tracker_.num_examined_vertices();
    if (partial_ != nullptr) {
      partial_->singular = tracker_.Singular();
    }
    return report_;
  }

 private:
  // With the cells around them, ascending.
  const std::vector<uint32_t>& Singular() {
    const std::vector<uint32_t>& singular = tracker_.Singular();
    if (partial_ != nullptr && !singular.empty()) {
      partial_->complete(singular);
    }
    return singular;
  }

  void FixByPaper() {
    KeepLargestComponents(Singular());
    SplitSmallComponents(Singular());
    KeepLargestComponents(Singular());
  }

  void FixByEnergy() {
    FlipWhileBetter();
    for (int round = 0; round < kMaxSplitRounds && !tracker_.Singular().empty();
         ++round) {
      SplitAndFlip();
    }
  }

  // Makes flips that reduce the number of components until there is none.
  void FlipWhileBetter() {
    size_t num_flips = 0;
    do {
      num_flips = tracker_.num_flips();
      FlipBest(Singular(), /*max_excess=*/-1);
    } while (tracker_.num_flips() != num_flips);
  }

  // Splits the cells around vertices where no flip is better any more, and
  // makes flips there that are no worse, or else those of the paper, so that
  // better ones may follow. Takes them back where no fewer vertices are
  // singular in the end.
  void SplitAndFlip() {
    const std::vector<uint32_t> singular = Singular();
    SplitSmallComponents(singular);
    const size_t num_flips = tracker_.num_flips();
    FlipBest(singular, /*max_excess=*/0);
    FlipWhileBetter();
    if (tracker_.Singular().size() < singular.size()) {
      return;
    }
    tracker_.UndoFlips(num_flips);
    KeepLargestComponents(singular);
    FlipWhileBetter();
    if (tracker_.Singular().size() >= singular.size()) {
      tracker_.UndoFlips(num_flips);
    }
  }

  // Whether a vertex is known to be.
  bool IsRegular(uint32_t vertex) const {
    return tracker_.IsRegular(vertex) &&
           (partial_ == nullptr || partial_->is_examined(vertex));
  }

  // Flips what is best at one vertex after the other. Some at a time are chosen
  // side by side, and once more where an earlier flip of these changed what was
  // looked at.
  // \pre the tracker's singular vertices are up to date, and vertices stay as
  //      they are
  void FlipBest(const std::vector<uint32_t>& vertices, int64_t max_excess) {
    const auto best = [&](size_t i) {
      return BestFlip(*tetrahedra_, *graph_, vertices[i], max_excess, *is_free_,
                      [this](uint32_t vertex) { return IsRegular(vertex); });
    };
    std::vector<std::vector<uint32_t>> flips(vertices.size());
    for (size_t begin = 0; begin < flips.size(); begin += kSideBySide) {
      const size_t end = std::min(begin + kSideBySide, flips.size());
      tbb::parallel_for(begin, end, [&](size_t i) { flips[i] = best(i); });
      touched_.clear();
      for (size_t i = begin; i < end; ++i) {
        Flip(IsTouchedAround(vertices[i]) ? best(i) : flips[i]);
      }
    }
  }

  void Flip(const std::vector<uint32_t>& cells) {
    tracker_.Flip(cells);
    for (const uint32_t cell : cells) {
      const auto& vertices = tetrahedra_->cells[cell].vertices;
      touched_.insert(vertices.begin(), vertices.end());
    }
    touched_.erase(kInfiniteVertex);
  }

  // Whether labels have changed that BestFlip looks at.
  bool IsTouchedAround(uint32_t vertex) {
    IncidentCells(*tetrahedra_, vertex, &cells_);
    return std::ranges::any_of(cells_, [this](uint32_t cell) {
      return std::ranges::any_of(
          tetrahedra_->cells[cell].vertices,
          [this](uint32_t corner) { return touched_.contains(corner); });
    });
  }

  // The paper's rule, first for matter and then for free space: flips all
  // components of a label around a singular vertex but the largest.
  void KeepLargestComponents(const std::vector<uint32_t>& vertices) {
    for (const uint32_t vertex : vertices) {
      for (const bool is_free : {false, true}) {
        MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
        const std::optional<size_t> largest = Largest(star_, is_free);
        for (size_t i = 0; star_.IsSingular() && i < star_.NumComponents();
             ++i) {
          if (i != largest && (star_.is_free[i] != 0) == is_free) {
            tracker_.Flip(star_.Component(i));
          }
        }
      }
    }
  }

  // Splits the cells of all components but the largest of either label.
  void SplitSmallComponents(const std::vector<uint32_t>& vertices) {
    for (const uint32_t vertex : vertices) {
      MakeVertexStar(*tetrahedra_, *is_free_, vertex, &star_);
      const std::optional<size_t> largest_free = Largest(star_, true);
      const std::optional<size_t> largest_matter = Largest(star_, false);
      for (size_t i = 0; star_.IsSingular() && i < star_.NumComponents(); ++i) {
        if (i != largest_free && i != largest_matter) {
          SplitCells(star_.Component(i));
        }
      }
    }
  }

  void SplitCells(std::span<const uint32_t> cells) {
    for (const uint32_t cell : cells) {
      if (CanSplit(*tetrahedra_, cell)) {
        if (partial_ != nullptr) {
          partial_->split(cell);
        }
        SplitCell(cell, tetrahedra_, graph_, is_free_);
        ++report_.num_split_cells;
      }
    }
  }

  Tetrahedralization* tetrahedra_;
  FlowCapacities* graph_;
  std::vector<uint8_t>* is_free_;
  PartialComplex* partial_;
  SingularVertexTracker tracker_;
  FixingReport report_;
  VertexStar star_;              // of the current vertex
  std::vector<uint32_t> cells_;  // at the current vertex
  // At cells that were flipped since flips were chosen side by side.
  std::unordered_set<uint32_t> touched_;
};

}  // namespace

NodeCapacities PartOf(const NodeCapacities& cell, int part) {
  NodeCapacities share{{}, cell.source / 4, cell.sink / 4};
  share.arcs[part] = cell.arcs[part];
  if (part == 0) {
    share.source = cell.source - 3 * share.source;
    share.sink = cell.sink - 3 * share.sink;
  }
  return share;
}

bool CanSplit(const Tetrahedralization& tetrahedra, uint32_t cell) {
  if (tetrahedra.IsInfinite(cell)) {
    return false;
  }
  const Eigen::Vector3f centroid = Centroid(tetrahedra, cell);
  return std::ranges::all_of(kFacetCorners, [&](const auto& corners) {
    const auto at = [&](int k) -> const Eigen::Vector3f& {
      return tetrahedra.points[tetrahedra.cells[cell].vertices[corners[k]]];
    };
    return Orientation(at(0), at(1), at(2), centroid) > 0;
  });
}

void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra,
               FlowCapacities* graph, std::vector<uint8_t>* is_free) {
  const Tetrahedralization::Cell parent = tetrahedra->cells[cell];
  const auto first_new = static_cast<uint32_t>(tetrahedra->cells.size());
  const std::array<uint32_t, 4> children = {cell, first_new, first_new + 1,
                                            first_new + 2};
  const auto centroid = static_cast<uint32_t>(tetrahedra->points.size());
  tetrahedra->points.push_back(Centroid(*tetrahedra, cell));
  tetrahedra->vertex_cells.push_back(cell);
  tetrahedra->cells.resize(first_new + 3);
  if (graph != nullptr) {
    const NodeCapacities whole = (*graph)[cell];
    graph->resize(first_new + 3);
    for (int i = 0; i < 4; ++i) {
      (*graph)[children[i]] = PartOf(whole, i);
    }
  }
  is_free->resize(first_new + 3, (*is_free)[cell]);
  for (int i = 0; i < 4; ++i) {
    // The child that has the centroid in place of the parent's vertex i.
    Tetrahedralization::Cell child{parent.vertices, children};
    child.vertices[i] = centroid;
    child.neighbors[i] = parent.neighbors[i];
    tetrahedra->cells[children[i]] = child;
    const uint32_t outer = parent.neighbors[i];
    const int back = tetrahedra->FacetTo(outer, cell);
    tetrahedra->cells[outer].neighbors[back] = children[i];
    tetrahedra->vertex_cells[parent.vertices[i]] = children[(i + 1) % 4];
  }
}

FixingReport FixSingularVertices(FixingRule rule,
                                 Tetrahedralization* tetrahedra,
                                 FlowCapacities* graph,
                                 std::vector<uint8_t>* is_free,
                                 PartialComplex* partial) {
  return Fixer(tetrahedra, graph, is_free, partial).Run(rule);
}

}  // namespace colmap_ext
