#include "delaunay/visibility_weights.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext::quality_weights_test {

// From the circumscribing sphere's centre, which is equally far from all four
// corners.
double CosByCenter(const Tetrahedralization& tetrahedra, uint32_t cell,
                   int facet) {
  const auto corner = [&](int k) -> Eigen::Vector3d {
    return tetrahedra.PositionOf(tetrahedra.cells[cell].vertices[k]);
  };
  Eigen::Matrix3d rows;
  Eigen::Vector3d halves;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = corner(k + 1) - corner(0);
    rows.row(k) = edge.transpose();
    halves[k] = edge.squaredNorm() / 2;
  }
  const Eigen::Vector3d offset = rows.fullPivLu().solve(halves);
  const auto& [a, b, c] = kFacetCorners[facet];
  const Eigen::Vector3d inward =
      (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalized();
  return inward.dot(corner(0) + offset - corner(a)) / offset.norm();
}

TEST(CosFacetSphereAngle, IsTheCentersDistanceOverTheRadius) {
  Random random(1);
  std::vector<std::vector<Eigen::Vector3f>> sets;
  for (int trial = 0; trial < 20; ++trial) {
    sets.push_back(RandomPoints(50, 1000, &random));
  }
  // An apex above a facet's circumcentre: flat cells and steep ones.
  for (const float height : {0.01f, 1.0f, 4.9f, 5.0f, 6.0f, 100.0f}) {
    sets.push_back({{5, 0, 0}, {-3, 4, 0}, {-4, -3, 0}, {0, 0, height}});
  }
  for (const std::vector<Eigen::Vector3f>& points : sets) {
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
      for (int i = 0; i < 4; ++i) {
        const double cosine = CosFacetSphereAngle(tetrahedra, cell, i);
        if (tetrahedra.IsInfinite(cell)) {
          ASSERT_EQ(cosine, 1);
        } else {
          ASSERT_NEAR(cosine, CosByCenter(tetrahedra, cell, i), 1e-6);
        }
      }
    }
  }
}

TEST(AddQualityWeights, AreThoseOfTheWorseCellInBothDirections) {
  Random random(2);
  const Tetrahedralization tetrahedra =
      DelaunayOf(RandomPoints(200, 1000, &random));
  for (const double weight : {0.0, 1.0, 2.5}) {
    FlowCapacities graph = ZeroCapacities(tetrahedra);
    for (NodeCapacities& node : graph) {
      node.arcs.fill(100);  // it adds
    }
    AddQualityWeights(tetrahedra, weight, &graph);
    for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
      for (int i = 0; i < 4; ++i) {
        const uint32_t other = tetrahedra.cells[cell].neighbors[i];
        const int back = tetrahedra.FacetTo(other, cell);
        const double cosine =
            tetrahedra.IsInfinite(cell) && tetrahedra.IsInfinite(other)
                ? -1
                : std::min(CosFacetSphereAngle(tetrahedra, cell, i),
                           CosFacetSphereAngle(tetrahedra, other, back));
        ASSERT_NEAR(graph[cell].arcs[i],
                    100 + kWeightUnit * weight * (1 - cosine), 0.51);
        ASSERT_EQ(graph[cell].arcs[i], graph[other].arcs[back]);
      }
      ASSERT_EQ(graph[cell].source + graph[cell].sink, 0u);
    }
  }
}

}  // namespace colmap_ext::quality_weights_test
