#include <gtest/gtest.h>

#include "meshing/manifold_fixing.h"
#include "tests/meshing/fixing_problem.h"

namespace colmap_ext {
namespace partial_complex_test {

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

class PartialComplexTest : public testing::TestWithParam<FixingRule> {};

TEST_P(PartialComplexTest, IsFixedAsTheWholeIs) {
  Random random(9);
  const FixingProblem whole = LargeProblemWithFewSingularVertices(300, &random);
  FixingProblem expected = whole;
  FixSingularVertices(GetParam(), &expected.tetrahedra, &expected.graph,
                      &expected.labels);
  HiddenProblem problem(whole);
  size_t num_splits = 0;
  PartialComplex partial = {whole.Singular(), [](uint32_t) { return true; },
                            [&problem](const std::vector<uint32_t>& vertices) {
                              problem.ShowAround(vertices);
                            },
                            [&num_splits](uint32_t) { ++num_splits; }};
  FixingProblem& fixed = problem.Hidden();
  const FixingReport report = FixSingularVertices(
      GetParam(), &fixed.tetrahedra, &fixed.graph, &fixed.labels, &partial);
  EXPECT_GT(report.num_singular_raw, 200u);
  EXPECT_LT(report.num_examined_vertices, whole.tetrahedra.points.size());
  EXPECT_GT(problem.ShowAll(), whole.labels.size() / 10);
  EXPECT_EQ(fixed.labels, expected.labels);
  EXPECT_EQ(num_splits, report.num_split_cells);
  EXPECT_EQ(partial.singular, fixed.Singular());
  ExpectSameCells(fixed.tetrahedra, expected.tetrahedra);
}

INSTANTIATE_TEST_SUITE_P(Rules, PartialComplexTest,
                         testing::Values(FixingRule::kPaper,
                                         FixingRule::kEnergy));

}  // namespace partial_complex_test
}  // namespace colmap_ext
