#include "meshing/manifold_fixing.h"

#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "mesh/manifold_repair.h"
#include "mesh/topology.h"
#include "meshing/singular_vertices.h"
#include "tests/delaunay/random_complex.h"
#include "tests/mesh/manifold_links.h"
#include "tests/meshing/fixing_problem.h"
#include "tests/threads.h"

namespace colmap_ext::manifold_fixing_test {

using Problem = FixingProblem;

class FixSingularVerticesTest : public testing::TestWithParam<FixingRule> {};

TEST_P(FixSingularVerticesTest, LeavesNothingThatTheSplitCannotRepair) {
  Random random(2);
  size_t num_raw = 0;
  size_t num_fixed = 0;
  size_t num_split_cells = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Problem problem = RandomProblem(
        RandomPoints(5 + random.Below(40), 1000, &random), &random);
    const Problem before = problem;
    const FixingReport report = problem.Fix(GetParam());
    problem.ExpectConsistent();
    ASSERT_FALSE(HasFailure());
    ASSERT_EQ(report.num_singular_raw, before.Singular().size());
    ASSERT_EQ(report.num_singular_fixed, problem.Singular().size());
    ASSERT_EQ(problem.labels.size(),
              before.labels.size() + 3 * report.num_split_cells);
    ASSERT_EQ(problem.tetrahedra.points.size(),
              before.tetrahedra.points.size() + report.num_split_cells);
    if (report.num_singular_raw == 0) {
      ASSERT_EQ(problem.labels, before.labels);
    }
    if (GetParam() == FixingRule::kEnergy) {
      ASSERT_LE(problem.Excess(), before.Excess());
    }
    if (report.num_split_cells == 0) {
      size_t num_changed = 0;
      for (size_t i = 0; i < before.labels.size(); ++i) {
        num_changed += before.labels[i] != problem.labels[i];
      }
      ASSERT_LE(num_changed, report.num_relabeled_cells);
      ASSERT_EQ(num_changed % 2, report.num_relabeled_cells % 2);
    }
    const ExtractedSurface surface =
        ExtractSurface(problem.tetrahedra, problem.labels);
    const FanSplit split = SplitFans(surface.mesh, surface.partners);
    const MeshReport mesh = Analyze(split.mesh);
    ASSERT_TRUE(mesh.IsManifold()) << mesh.Defects();
    ASSERT_TRUE(HasManifoldLinks(split.mesh));
    num_raw += report.num_singular_raw;
    num_fixed += report.num_singular_fixed;
    num_split_cells += report.num_split_cells;
  }
  if (GetParam() == FixingRule::kPaper) {
    EXPECT_GT(num_split_cells, 0u);  // the energy rule hardly ever needs it
  }
  // Noise as labels is harder than any surface.
  EXPECT_LT(num_fixed, 0.6 * static_cast<double>(num_raw));
}

TEST_P(FixSingularVerticesTest, IsWhatExaminingAllVerticesAfterEachPassGives) {
  Random random(6);
  const std::vector<NamedPoints> difficult = DifficultPoints();
  size_t num_relabeled_cells = 0;
  size_t num_split_cells = 0;
  for (uint32_t trial = 0; trial < 160; ++trial) {
    // Centroids of far points are rounded out of their cells.
    Problem problem = RandomProblem(
        trial % 2 == 0   ? RandomPoints(5 + random.Below(60), 1000, &random)
        : trial % 8 == 1 ? FarPoints(40, &random)
                         : difficult[trial / 2 % difficult.size()].points,
        &random);
    Problem expected = problem;
    const FixingReport report = problem.Fix(GetParam());
    const FixingReport reference = expected.FixAsReference(GetParam());
    ASSERT_EQ(report.num_singular_raw, reference.num_singular_raw);
    ASSERT_EQ(report.num_singular_fixed, reference.num_singular_fixed);
    ASSERT_EQ(report.num_relabeled_cells, reference.num_relabeled_cells);
    ASSERT_EQ(report.num_split_cells, reference.num_split_cells);
    ASSERT_TRUE(problem == expected);
    ASSERT_TRUE(ArePositive(problem.tetrahedra)) << trial;
    num_relabeled_cells += report.num_relabeled_cells;
    num_split_cells += report.num_split_cells;
  }
  EXPECT_GT(num_relabeled_cells, 1000u);
  EXPECT_GT(num_split_cells, 0u);
}

// The cost without a clock: all vertices are examined once, and then those
// around what was relabelled alone.
TEST_P(FixSingularVerticesTest, ExaminesVerticesInProportionToTheSingularOnes) {
  Random random(7);
  for (const int num_pairs : {0, 5, 20}) {
    Problem problem = LargeProblemWithFewSingularVertices(num_pairs, &random);
    Problem copy = problem;
    const size_t num_vertices = problem.tetrahedra.points.size();
    const FixingReport report = problem.Fix(GetParam());
    ASSERT_GE(report.num_singular_raw, num_pairs / 2);
    const size_t bound = num_vertices + 100 * report.num_singular_raw;
    EXPECT_GE(report.num_examined_vertices, num_vertices);
    EXPECT_LE(report.num_examined_vertices, bound);
    EXPECT_GT(copy.FixAsReference(GetParam()).num_examined_vertices, bound);
    EXPECT_EQ(problem.labels, copy.labels);
  }
}

TEST_P(FixSingularVerticesTest, IsTheSameAtEveryNumberOfThreads) {
  Random random(8);
  const Problem problem = LargeProblemWithFewSingularVertices(300, &random);
  ExpectSameForAnyThreads([&] {
    Problem fixed = problem;
    EXPECT_GT(fixed.Fix(GetParam()).num_singular_raw, 200u);
    return fixed;
  });
}

// A problem whose labels are wrong but for the cells that were asked for.
class HiddenProblem {
 public:
  explicit HiddenProblem(const FixingProblem& whole)
      : whole_(whole), hidden_(whole), is_shown_(whole.labels.size(), 0) {
    for (uint8_t& label : hidden_.labels) {
      label = !label;
    }
  }

  FixingProblem& Hidden() { return hidden_; }

  // Shows two rings of cells.
  void ShowAround(const std::vector<uint32_t>& vertices) {
    for (const uint32_t vertex : vertices) {
      ForEachCell(vertex, [this](uint32_t cell) {
        for (const uint32_t corner : hidden_.tetrahedra.cells[cell].vertices) {
          if (corner != kInfiniteVertex) {
            ForEachCell(corner, [this](uint32_t shown) { Show(shown); });
          }
        }
      });
    }
  }

  // \return how many cells were never asked for
  size_t ShowAll() {
    size_t num_hidden = 0;
    for (uint32_t cell = 0; cell < is_shown_.size(); ++cell) {
      num_hidden += is_shown_[cell] == 0;
      Show(cell);
    }
    return num_hidden;
  }

 private:
  template <typename Function>
  void ForEachCell(uint32_t vertex, const Function& function) const {
    std::vector<uint32_t> cells;
    IncidentCells(hidden_.tetrahedra, vertex, &cells);
    for (const uint32_t cell : cells) {
      function(cell);
    }
  }

  // Children of split cells have the right label.
  void Show(uint32_t cell) {
    if (cell < is_shown_.size() && is_shown_[cell] == 0) {
      is_shown_[cell] = 1;
      hidden_.labels[cell] = whole_.labels[cell];
    }
  }

  const FixingProblem& whole_;
  FixingProblem hidden_;
  std::vector<uint8_t> is_shown_;  // [cells of the whole]
};

TEST_P(FixSingularVerticesTest, FixesAPartialComplexAsTheWhole) {
  Random random(9);
  const FixingProblem whole = LargeProblemWithFewSingularVertices(300, &random);
  FixingProblem expected = whole;
  expected.Fix(GetParam());
  HiddenProblem problem(whole);
  size_t num_splits = 0;
  PartialComplex partial = {whole.Singular(), [](uint32_t) { return true; },
                            [&problem](const std::vector<uint32_t>& vertices) {
                              problem.ShowAround(vertices);
                            },
                            [&num_splits](uint32_t) { ++num_splits; }};
  FixingProblem& fixed = problem.Hidden();
  const FixingReport report = fixed.Fix(GetParam(), &partial);
  EXPECT_GT(report.num_singular_raw, 200u);
  EXPECT_LT(report.num_examined_vertices, whole.tetrahedra.points.size());
  EXPECT_GT(problem.ShowAll(), whole.labels.size() / 10);
  EXPECT_TRUE(fixed == expected);
  EXPECT_EQ(num_splits, report.num_split_cells);
  EXPECT_EQ(partial.singular, fixed.Singular());
}

INSTANTIATE_TEST_SUITE_P(
    Rules, FixSingularVerticesTest,
    testing::Values(FixingRule::kPaper, FixingRule::kEnergy),
    [](const auto& rule) {
      return std::string(rule.param == FixingRule::kPaper ? "Paper" : "Energy");
    });

using Cells = std::vector<uint32_t>;

// The components of one label around a vertex.
std::vector<Cells> ComponentsOf(const Problem& problem, uint32_t vertex,
                                bool is_free) {
  VertexStar star;
  MakeVertexStar(problem.tetrahedra, problem.labels, vertex, &star);
  std::vector<Cells> components;
  for (size_t i = 0; i < star.NumComponents(); ++i) {
    if ((star.is_free[i] != 0) == is_free) {
      const auto component = star.Component(i);
      components.emplace_back(component.begin(), component.end());
    }
  }
  return components;
}

void Flip(const Cells& cells, Problem* problem) {
  for (const uint32_t cell : cells) {
    problem->labels[cell] = !problem->labels[cell];
  }
}

// Flips all components of one label around a vertex but the how-manieth.
Problem KeepOne(const Problem& problem, uint32_t vertex, bool is_free,
                size_t kept) {
  Problem result = problem;
  const auto components = ComponentsOf(problem, vertex, is_free);
  for (size_t i = 0; i < components.size(); ++i) {
    if (i != kept) {
      Flip(components[i], &result);
    }
  }
  return result;
}

// The least excess, and the least energy among the flips that leave it: of one
// component around the vertex, and of all but one of either label, one label
// after the other.
std::tuple<size_t, int64_t> LeastExcessAndEnergy(const Problem& problem,
                                                 uint32_t vertex) {
  std::tuple<size_t, int64_t> best = {SIZE_MAX, 0};
  const auto try_out = [&](const Problem& flipped) {
    best = std::min(best, {flipped.Excess(), flipped.Energy()});
  };
  for (const bool label : {false, true}) {
    const auto components = ComponentsOf(problem, vertex, label);
    for (size_t first = 0; first < components.size(); ++first) {
      Problem flipped = problem;
      Flip(components[first], &flipped);
      try_out(flipped);
      const Problem once = KeepOne(problem, vertex, label, first);
      const size_t count = ComponentsOf(once, vertex, !label).size();
      for (size_t second = 0; second < count; ++second) {
        try_out(KeepOne(once, vertex, !label, second));
      }
    }
  }
  return best;
}

// Calls function(problem, vertex) for problems where just that vertex is
// singular.
template <typename Function>
void ForEachSingleVertex(uint64_t seed, const Function& function) {
  Random random(seed);
  for (int complex = 0; complex < 300; ++complex) {
    Problem problem = RandomProblem(
        RandomPoints(10 + random.Below(30), 1000, &random), &random);
    for (int trial = 0; trial < 60; ++trial) {
      problem.labels = RandomLabels(problem.tetrahedra, &random);
      const std::vector<uint32_t> singular = problem.Singular();
      if (singular.size() == 1) {
        function(problem, singular.front());
      }
    }
  }
}

TEST(EnergyRule, TakesTheCheapestOfTheLeastExcessAndEnergys) {
  size_t num_tried = 0;
  ForEachSingleVertex(4, [&](Problem problem, uint32_t vertex) {
    const auto best = LeastExcessAndEnergy(problem, vertex);
    const FixingReport report = problem.Fix(FixingRule::kEnergy);
    if (std::get<0>(best) > 0) {
      return;  // it has to split cells
    }
    ++num_tried;
    EXPECT_EQ(report.num_singular_fixed, 0u);
    EXPECT_EQ(report.num_split_cells, 0u);
    EXPECT_EQ(problem.Energy(), std::get<1>(best));
  });
  EXPECT_GT(num_tried, 50u);
}

// The paper's rule keeps the component with the most cells.
TEST(PaperRule, KeepsTheLargestComponents) {
  size_t num_tried = 0;
  ForEachSingleVertex(5, [&](Problem problem, uint32_t vertex) {
    Problem expected = problem;
    for (const bool is_free : {false, true}) {
      const auto components = ComponentsOf(expected, vertex, is_free);
      const auto largest = std::ranges::max_element(
          components,
          [](const auto& a, const auto& b) { return a.size() < b.size(); });
      expected = KeepOne(expected, vertex, is_free,
                         static_cast<size_t>(largest - components.begin()));
    }
    const FixingReport report = problem.Fix(FixingRule::kPaper);
    if (expected.Singular().empty()) {
      ++num_tried;
      EXPECT_EQ(problem.labels, expected.labels);
      EXPECT_EQ(report.num_singular_fixed, 0u);
    }
  });
  EXPECT_GT(num_tried, 50u);
}

}  // namespace colmap_ext::manifold_fixing_test
