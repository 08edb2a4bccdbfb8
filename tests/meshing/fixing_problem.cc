#include "tests/meshing/fixing_problem.h"

#include <gtest/gtest.h>

#include "meshing/singular_vertices.h"
#include "meshing/vertex_star.h"
#include "tests/delaunay/random_complex.h"

namespace colmap_ext {

std::vector<uint32_t> FixingProblem::Singular() const {
  return SingularVertices(tetrahedra, labels);
}

size_t FixingProblem::Excess() const {
  size_t excess = 0;
  VertexStar star;
  for (const uint32_t vertex : Singular()) {
    MakeVertexStar(tetrahedra, labels, vertex, &star);
    excess += star.NumComponents() - 2;
  }
  return excess;
}

FixingProblem RandomProblem(const std::vector<Eigen::Vector3f>& points,
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

void ExpectConsistent(const FixingProblem& problem) {
  ASSERT_EQ(DefectOf(problem.tetrahedra, false), "");
  ASSERT_EQ(problem.graph.size(), problem.tetrahedra.cells.size());
  ASSERT_EQ(problem.labels.size(), problem.tetrahedra.cells.size());
}

void ExpectSameCells(const Tetrahedralization& a, const Tetrahedralization& b) {
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (size_t i = 0; i < a.cells.size(); ++i) {
    ASSERT_EQ(a.cells[i].vertices, b.cells[i].vertices);
    ASSERT_EQ(a.cells[i].neighbors, b.cells[i].neighbors);
  }
}

}  // namespace colmap_ext
