#include "tests/meshing/fixing_problem.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "meshing/singular_vertices.h"
#include "spatial/predicates.h"
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

FixingProblem LargeProblemWithFewSingularVertices(int num_pairs,
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
    const uint32_t vertex =
        random->Below(static_cast<uint32_t>(tetrahedra.points.size()));
    IncidentCells(tetrahedra, vertex, &cells);
    for (const uint32_t cell : {cells.front(), cells.back()}) {
      problem.labels[cell] = !problem.labels[cell];
    }
  }
  return problem;
}

std::vector<Eigen::Vector3f> FarPoints(uint32_t num_points, Random* random) {
  std::vector<Eigen::Vector3f> points = RandomPoints(num_points, 4, random);
  for (Eigen::Vector3f& point : points) {
    point.array() += 0x1p23f + 100;
  }
  return points;
}

bool ArePositive(const Tetrahedralization& tetrahedra) {
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

void FixingProblem::ExpectConsistent() const {
  ASSERT_EQ(DefectOf(tetrahedra, false), "");
  ASSERT_EQ(graph.size(), tetrahedra.cells.size());
  ASSERT_EQ(labels.size(), tetrahedra.cells.size());
}

}  // namespace colmap_ext
