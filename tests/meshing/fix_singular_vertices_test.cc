#include "meshing/fix_singular_vertices.h"

#include <gtest/gtest.h>

#include "mesh/split_fans.h"
#include "tests/mesh/manifold_links.h"
#include "tests/meshing/fixing_problem.h"
#include "tests/threads.h"

namespace colmap_ext::fix_singular_vertices_test {

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
    if (GetParam() == FixingRule::kEnergy) {
      ASSERT_LE(problem.Excess(), before.Excess());
    }
    const ExtractedSurface surface =
        ExtractSurface(problem.tetrahedra, problem.labels);
    const FanSplit split = SplitFans(surface.mesh, surface.partners);
    ExpectManifoldMesh(split.mesh);
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
    const FixingReport reference = ReferenceFixing(&expected).Run(GetParam());
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
    EXPECT_GT(ReferenceFixing(&copy).Run(GetParam()).num_examined_vertices,
              bound);
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

}  // namespace colmap_ext::fix_singular_vertices_test
