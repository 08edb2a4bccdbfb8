#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "base/indices.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "meshing/fix_singular_vertices.h"
#include "meshing/singular_vertices.h"
#include "optim/min_cut.h"
#include "spatial/predicates.h"
#include "tests/delaunay/random_complex.h"

namespace colmap_ext {

// Labelled cells and the graph whose cut the labels are.
struct FixingProblem {
  Tetrahedralization tetrahedra;
  FlowCapacities graph;         // node i is cell i
  std::vector<uint8_t> labels;  // [C], 1: free space, 0: matter

  std::vector<uint32_t> Singular() const {
    return SingularVertices(tetrahedra, labels);
  }

  int64_t Energy() const {
    return CutValue(NeighborsOf(tetrahedra), graph, labels);
  }

  // Components beyond the second, summed over all vertices.
  size_t Excess() const {
    size_t excess = 0;
    VertexStar star;
    for (const uint32_t vertex : Singular()) {
      MakeVertexStar(tetrahedra, labels, vertex, &star);
      excess += star.NumComponents() - 2;
    }
    return excess;
  }

  FixingReport Fix(FixingRule rule, PartialComplex* partial = nullptr) {
    return FixSingularVertices(rule, &tetrahedra, &graph, &labels, partial);
  }

  // Fails where the arrays do not agree with each other.
  void ExpectConsistent() const {
    ASSERT_EQ(DefectOf(tetrahedra, false), "");
    ASSERT_EQ(graph.size(), tetrahedra.cells.size());
    ASSERT_EQ(labels.size(), tetrahedra.cells.size());
  }

  bool operator==(const FixingProblem&) const = default;
};

// What FixSingularVertices does, written down without regard for time: after
// every pass all vertices are examined again, labels are copied to be put back.
class ReferenceFixing {
 public:
  explicit ReferenceFixing(FixingProblem* problem)
      : problem_(*problem),
        tetrahedra_(problem->tetrahedra),
        is_free_(problem->labels) {}

  FixingReport Run(FixingRule rule) {
    report_.num_singular_raw = Singular().size();
    if (rule == FixingRule::kPaper) {
      KeepLargest(Singular());
      Split(Singular());
      KeepLargest(Singular());
    } else {
      FixByEnergy();
    }
    report_.num_singular_fixed = Singular().size();
    return report_;
  }

 private:
  using Cells = std::vector<uint32_t>;

  VertexStar Star(uint32_t vertex) const {
    VertexStar star;
    MakeVertexStar(tetrahedra_, is_free_, vertex, &star);
    return star;
  }

  std::vector<uint32_t> Singular() {
    std::vector<uint32_t> singular;
    for (uint32_t vertex = 0; vertex < tetrahedra_.points.size(); ++vertex) {
      ++report_.num_examined_vertices;
      if (Star(vertex).IsSingular()) {
        singular.push_back(vertex);
      }
    }
    return singular;
  }

  void Flip(const Cells& cells) {
    for (const uint32_t cell : cells) {
      is_free_[cell] = !is_free_[cell];
    }
  }

  void FixByEnergy() {
    FlipWhileBetter();
    for (int round = 0; round < 3 && !Singular().empty(); ++round) {
      const std::vector<uint32_t> singular = Singular();
      Split(singular);
      const std::vector<uint8_t> labels = is_free_;
      const size_t num_relabeled = report_.num_relabeled_cells;
      for (const bool is_paper : {false, true}) {
        if (is_paper) {
          KeepLargest(singular);
        } else {
          FlipBest(singular, 0);
        }
        FlipWhileBetter();
        if (Singular().size() < singular.size()) {
          break;
        }
        is_free_ = labels;
        report_.num_relabeled_cells = num_relabeled;
      }
    }
  }

  void FlipWhileBetter() {
    size_t before = 0;
    do {
      before = report_.num_relabeled_cells;
      FlipBest(Singular(), -1);
    } while (report_.num_relabeled_cells != before);
  }

  void FlipBest(const std::vector<uint32_t>& vertices, int64_t max_excess) {
    for (const uint32_t vertex : vertices) {
      std::pair<int64_t, int64_t> best = {max_excess + 1,
                                          std::numeric_limits<int64_t>::min()};
      Cells best_cells;
      for (const Cells& cells : Candidates(vertex)) {
        std::pair<int64_t, int64_t> change = {-Excess(cells),
                                              -problem_.Energy()};
        Flip(cells);
        change.first += Excess(cells);
        change.second += problem_.Energy();
        Flip(cells);
        if (change < best) {
          best = change;
          best_cells = cells;
        }
      }
      Flip(best_cells);
      report_.num_relabeled_cells += best_cells.size();
    }
  }

  // One component, or all but one of either label, one label after the other.
  std::vector<Cells> Candidates(uint32_t vertex) {
    const VertexStar star = Star(vertex);
    std::vector<Cells> candidates;
    if (!star.IsSingular()) {
      return candidates;
    }
    const std::vector<uint8_t> labels = is_free_;
    for (size_t first = 0; first < star.NumComponents(); ++first) {
      const auto component = star.Component(first);
      candidates.emplace_back(component.begin(), component.end());
      KeepOnly(star, first);
      const std::vector<uint8_t> once = is_free_;
      const VertexStar then = Star(vertex);
      for (size_t second = 0; second < then.NumComponents(); ++second) {
        if (then.is_free[second] != star.is_free[first]) {
          KeepOnly(then, second);
          Cells& cells = candidates.emplace_back();
          for (const uint32_t cell : star.cells) {
            if (is_free_[cell] != labels[cell]) {
              cells.push_back(cell);
            }
          }
          is_free_ = once;
        }
      }
      is_free_ = labels;
    }
    return candidates;
  }

  // Flips all components of the kept one's label but that one.
  size_t KeepOnly(const VertexStar& star, size_t kept) {
    size_t num_flipped = 0;
    for (size_t i = 0; i < star.NumComponents(); ++i) {
      if (i != kept && star.is_free[i] == star.is_free[kept]) {
        Flip({star.Component(i).begin(), star.Component(i).end()});
        num_flipped += star.Component(i).size();
      }
    }
    return num_flipped;
  }

  int64_t Excess(const Cells& cells) const {
    std::vector<uint32_t> vertices;
    for (const uint32_t cell : cells) {
      for (const uint32_t vertex : tetrahedra_.cells[cell].vertices) {
        if (vertex != kInfiniteVertex) {
          vertices.push_back(vertex);
        }
      }
    }
    SortUnique(&vertices);
    int64_t excess = 0;
    for (const uint32_t vertex : vertices) {
      excess += std::max<int64_t>(
          0, static_cast<int64_t>(Star(vertex).NumComponents()) - 2);
    }
    return excess;
  }

  static size_t Largest(const VertexStar& star, bool is_free) {
    size_t largest = SIZE_MAX;
    for (size_t i = 0; i < star.NumComponents(); ++i) {
      if ((star.is_free[i] != 0) == is_free &&
          (largest == SIZE_MAX ||
           star.Component(i).size() > star.Component(largest).size())) {
        largest = i;
      }
    }
    return largest;
  }

  void KeepLargest(const std::vector<uint32_t>& vertices) {
    for (const uint32_t vertex : vertices) {
      for (const bool is_free : {false, true}) {
        const VertexStar star = Star(vertex);
        if (star.IsSingular()) {
          report_.num_relabeled_cells += KeepOnly(star, Largest(star, is_free));
        }
      }
    }
  }

  void Split(const std::vector<uint32_t>& vertices) {
    for (const uint32_t vertex : vertices) {
      const VertexStar star = Star(vertex);
      for (size_t i = 0; i < star.NumComponents() && star.IsSingular(); ++i) {
        if (i == Largest(star, true) || i == Largest(star, false)) {
          continue;
        }
        for (const uint32_t cell : star.Component(i)) {
          if (CanSplit(tetrahedra_, cell)) {
            SplitCell(cell, &tetrahedra_, &problem_.graph, &is_free_);
            ++report_.num_split_cells;
          }
        }
      }
    }
  }

  FixingProblem& problem_;
  Tetrahedralization& tetrahedra_;
  std::vector<uint8_t>& is_free_;
  FixingReport report_;
};

inline FixingProblem RandomProblem(const std::vector<Eigen::Vector3f>& points,
                                   Random* random) {
  FixingProblem problem;
  problem.tetrahedra = DelaunayOf(points);
  problem.graph = RandomGraphOf(problem.tetrahedra, 1000, random);
  problem.labels = RandomLabels(problem.tetrahedra, random);
  if (random->Chance(0.3)) {
    LabelInfinite(problem.tetrahedra, true, &problem.labels);
  }
  return problem;
}

// Free space on one side of a plane, matter on the other, and pairs of cells of
// the other label that meet in one vertex.
inline FixingProblem LargeProblemWithFewSingularVertices(int num_pairs,
                                                         Random* random) {
  FixingProblem problem;
  problem.tetrahedra = DelaunayOf(RandomPoints(6000, 1 << 20, random));
  const Tetrahedralization& tetrahedra = problem.tetrahedra;
  problem.graph = RandomGraphOf(tetrahedra, 1000, random);
  for (const auto& cell : tetrahedra.cells) {
    problem.labels.push_back(
        tetrahedra.points[std::ranges::min(cell.vertices)].x() > 0);
  }
  std::vector<uint32_t> cells;
  for (int pair = 0; pair < num_pairs; ++pair) {
    IncidentCells(tetrahedra, random->Below(tetrahedra.points.size()), &cells);
    for (const uint32_t cell : {cells.front(), cells.back()}) {
      problem.labels[cell] = !problem.labels[cell];
    }
  }
  return problem;
}

// Neighboring floats far from the origin, a unit apart.
inline std::vector<Eigen::Vector3f> FarPoints(uint32_t num_points,
                                              Random* random) {
  std::vector<Eigen::Vector3f> points = RandomPoints(num_points, 4, random);
  for (Eigen::Vector3f& point : points) {
    point.array() += 0x1p23f + 100;
  }
  return points;
}

// Whether all finite cells are positively oriented.
inline bool ArePositive(const Tetrahedralization& tetrahedra) {
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    const auto& [a, b, c, d] = tetrahedra.cells[cell].vertices;
    const auto& p = tetrahedra.points;
    if (!tetrahedra.IsInfinite(cell) &&
        Orientation(p[a], p[b], p[c], p[d]) <= 0) {
      return false;
    }
  }
  return true;
}

}  // namespace colmap_ext
