#include "meshing/manifold_fixing.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"
#include "tests/meshing/fixing_problem.h"

namespace colmap_ext {
namespace cell_splitting_test {

TEST(SplitCell, KeepsEverythingButTheCell) {
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    FixingProblem problem =
        RandomProblem(RandomPoints(20, 1000, &random), &random);
    for (int split = 0; split < 30; ++split) {
      const FixingProblem before = problem;
      const auto num_cells =
          static_cast<uint32_t>(before.tetrahedra.cells.size());
      const auto num_points =
          static_cast<uint32_t>(before.tetrahedra.points.size());
      const uint32_t cell = random.Below(num_cells);
      if (!CanSplit(before.tetrahedra, cell)) {
        ASSERT_TRUE(before.tetrahedra.IsInfinite(cell));
        continue;
      }
      SplitCell(cell, &problem.tetrahedra, &problem.graph, &problem.labels);
      problem.ExpectConsistent();
      ASSERT_FALSE(HasFailure());
      ASSERT_EQ(problem.tetrahedra.cells.size(), num_cells + 3);
      ASSERT_EQ(problem.tetrahedra.points.size(), num_points + 1);
      // The energy of the inherited labels, and the terminals' capacities.
      ASSERT_EQ(problem.Energy(), before.Energy());
      for (const auto terminal :
           {&NodeCapacities::source, &NodeCapacities::sink}) {
        ASSERT_EQ(SumOf(problem.graph, terminal),
                  SumOf(before.graph, terminal));
      }
      ASSERT_EQ(problem.Singular(), before.Singular());
      Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
      for (const uint32_t vertex : before.tetrahedra.cells[cell].vertices) {
        centroid += 0.25f * before.tetrahedra.points[vertex];
      }
      EXPECT_LT((problem.tetrahedra.points.back() - centroid).norm(), 1e-2);
      for (const uint32_t child :
           {cell, num_cells, num_cells + 1, num_cells + 2}) {
        ASSERT_EQ(problem.labels[child], before.labels[cell]);
        ASSERT_EQ(std::ranges::count(problem.tetrahedra.cells[child].vertices,
                                     num_points),
                  1);
      }
      // All other cells are as they were.
      for (uint32_t other = 0; other < num_cells; ++other) {
        if (other != cell) {
          ASSERT_EQ(problem.labels[other], before.labels[other]);
          ASSERT_EQ(problem.tetrahedra.cells[other].vertices,
                    before.tetrahedra.cells[other].vertices);
          ASSERT_EQ(problem.graph[other].arcs, before.graph[other].arcs);
        }
      }
    }
  }
}

// Where coordinates are so large that centroids are rounded out of their cells.
TEST(SplitCell, PartsArePositivelyOriented) {
  Random random(2);
  int num_split = 0;
  int num_refused = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const FixingProblem problem =
        RandomProblem(FarPoints(20, &random), &random);
    for (uint32_t cell = 0; cell < problem.tetrahedra.cells.size(); ++cell) {
      FixingProblem split = problem;
      if (CanSplit(problem.tetrahedra, cell)) {
        ++num_split;
        SplitCell(cell, &split.tetrahedra, &split.graph, &split.labels);
        ASSERT_TRUE(ArePositive(split.tetrahedra));
      } else {
        num_refused += problem.tetrahedra.IsInfinite(cell) ? 0 : 1;
      }
    }
  }
  EXPECT_GT(num_split, 100);
  EXPECT_GT(num_refused, 100);
}

}  // namespace cell_splitting_test
}  // namespace colmap_ext
