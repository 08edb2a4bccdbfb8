#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/cell_graph.h"
#include "delaunay/tetrahedralization.h"
#include "meshing/manifold_fixing.h"
#include "optim/min_cut.h"
#include "tests/random.h"

namespace colmap_ext {

// Labelled cells and the graph whose cut the labels are.
struct FixingProblem {
  Tetrahedralization tetrahedra;
  FlowCapacities graph;         // node i is cell i
  std::vector<uint8_t> labels;  // [C], 1: free space, 0: matter

  std::vector<uint32_t> Singular() const;

  int64_t Energy() const {
    return CutValue(NeighborsOf(tetrahedra), graph, labels);
  }

  // Components beyond the second, summed over all vertices.
  size_t Excess() const;

  FixingReport Fix(FixingRule rule, PartialComplex* partial = nullptr) {
    return FixSingularVertices(rule, &tetrahedra, &graph, &labels, partial);
  }

  // What FixSingularVertices does, written down without regard for time: after
  // every pass all vertices are examined again, labels are copied to be put
  // back.
  FixingReport FixAsReference(FixingRule rule);

  // Fails where the arrays do not agree with each other.
  void ExpectConsistent() const;

  bool operator==(const FixingProblem&) const = default;
};

FixingProblem RandomProblem(const std::vector<Eigen::Vector3f>& points,
                            Random* random);

// Free space on one side of a plane, matter on the other, and pairs of cells of
// the other label that meet in one vertex.
FixingProblem LargeProblemWithFewSingularVertices(int num_pairs,
                                                  Random* random);

// Neighboring floats far from the origin, a unit apart.
std::vector<Eigen::Vector3f> FarPoints(uint32_t num_points, Random* random);

// Whether all finite cells are positively oriented.
bool ArePositive(const Tetrahedralization& tetrahedra);

}  // namespace colmap_ext
