#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "delaunay/ray_walk.h"
#include "tests/delaunay/random_complex.h"
#include "tests/threads.h"

namespace colmap_ext::weak_surfaces_test {

constexpr VisibilityWeightOptions kOptions{20, 1};

// Cameras within the hull.
struct Scenery : SeenComplex {
  explicit Scenery(uint32_t num_points)
      : SeenComplex(num_points, std::vector<int>(6, 150)) {}

  // Votes, and the free-space support. In every other cell it is taken away, or
  // no ray of a random scene would end sharply.
  FlowCapacities VoteHalfBlind(std::vector<uint32_t>* support) const {
    FlowCapacities graph = Vote(support);
    for (size_t cell = 0; cell < support->size(); cell += 2) {
      (*support)[cell] = 0;
    }
    return graph;
  }

  FlowCapacities Vote(std::vector<uint32_t>* support) const {
    FlowCapacities graph = ZeroCapacities(tetrahedra);
    AddVisibilityWeights(tetrahedra, observations, centers, kOptions, &graph,
                         {}, support);
    return graph;
  }

  // Calls function(vertex, center, alpha) for all observations.
  template <typename Function>
  void ForEachRay(const Function& function) const {
    for (uint32_t vertex = 0; vertex < observations.size(); ++vertex) {
      for (const auto& [view, alpha] : observations[vertex]) {
        function(vertex, centers[view], alpha);
      }
    }
  }
};

// How much of a segment lies in a finite cell, as a share: the segment is
// clipped by the planes of the four facets.
double ShareInCell(const Tetrahedralization& tetrahedra, uint32_t cell,
                   const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    corners[i] = tetrahedra.PositionOf(tetrahedra.cells[cell].vertices[i]);
  }
  double first = 0;
  double last = 1;
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d& corner = corners[(i + 1) % 4];
    Eigen::Vector3d normal = (corners[(i + 2) % 4] - corner)
                                 .cross(corners[(i + 3) % 4] - corner)
                                 .normalized();
    if (normal.dot(corners[i] - corner) < 0) {
      normal = -normal;
    }
    const double at_a = normal.dot(a - corner);
    const double slope = normal.dot(b - a);
    if (slope > 0) {
      first = std::max(first, -at_a / slope);
    } else if (slope < 0) {
      last = std::min(last, -at_a / slope);
    }
  }
  return last - first;
}

// The largest support of the finite cells that a segment passes through.
// Nothing where the segment only just touches one, and rounding decides.
std::optional<uint32_t> LargestByClipping(const Scenery& scenery,
                                          const std::vector<uint32_t>& support,
                                          const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b) {
  uint32_t largest = 0;
  for (uint32_t cell = 0; cell < support.size(); ++cell) {
    if (scenery.tetrahedra.IsInfinite(cell)) {
      continue;
    }
    const double share = ShareInCell(scenery.tetrahedra, cell, a, b);
    if (share > 1e-9) {
      largest = std::max(largest, support[cell]);
      if (share < 1e-6) {
        return std::nullopt;
      }
    }
  }
  return largest;
}

TEST(FreeSupport, IsTheSumOfTheRaysThroughACell) {
  const Scenery scenery(60);
  std::vector<uint32_t> support;
  scenery.Vote(&support);
  std::vector<double> expected(support.size(), 0);
  scenery.ForEachRay(
      [&](uint32_t vertex, const Eigen::Vector3d& center, float alpha) {
        const Eigen::Vector3d position = scenery.tetrahedra.PositionOf(vertex);
        for (uint32_t cell = 0; cell < support.size(); ++cell) {
          if (!scenery.tetrahedra.IsInfinite(cell) &&
              ShareInCell(scenery.tetrahedra, cell, position, center) > 1e-9) {
            expected[cell] += alpha;
          }
        }
      });
  for (uint32_t cell = 0; cell < support.size(); ++cell) {
    if (!scenery.tetrahedra.IsInfinite(cell)) {
      EXPECT_NEAR(support[cell] / kWeightUnit, expected[cell], 0.05) << cell;
    }
  }
}

TEST(MeasureJump, IsThatOfClippedCellsAndLosesRaysWithoutDirection) {
  const Scenery scenery(400);
  std::vector<uint32_t> support;
  scenery.Vote(&support);
  size_t num_compared = 0;
  for (uint32_t vertex = 0; vertex < 400; ++vertex) {
    const Eigen::Vector3d position = scenery.tetrahedra.PositionOf(vertex);
    const Eigen::Vector3d& center = scenery.centers[vertex % 6];
    const Eigen::Vector3d sigma =
        kOptions.distance_sigma * (position - center).normalized();
    const Eigen::Vector3d near = position - kFrontSigmas * sigma;
    const Eigen::Vector3d far = position + kBehindSigmas * sigma;
    if (scenery.tetrahedra.IsInfinite(Locate(scenery.tetrahedra, near, 0)) ||
        scenery.tetrahedra.IsInfinite(Locate(scenery.tetrahedra, far, 0))) {
      continue;
    }
    const std::optional<uint32_t> front =
        LargestByClipping(scenery, support, position, near);
    const std::optional<uint32_t> behind =
        LargestByClipping(scenery, support, position, far);
    if (!front || !behind) {
      continue;
    }
    const SupportJump jump =
        MeasureJump(scenery.tetrahedra, support, vertex, center, kOptions);
    EXPECT_EQ(jump.front, *front) << vertex;
    EXPECT_EQ(jump.behind, *behind) << vertex;
    EXPECT_TRUE(
        IsStrictlyInside(scenery.tetrahedra, jump.end_cell, position + sigma));
    ++num_compared;
  }
  EXPECT_GT(num_compared, 100u);
  const std::vector<uint32_t> ones(scenery.tetrahedra.cells.size(), 1);
  EXPECT_EQ(MeasureJump(scenery.tetrahedra, ones, 0,
                        scenery.tetrahedra.PositionOf(0), kOptions)
                .end_cell,
            kNone);
}

TEST(WeakSurfaceWeights, AreWhatEachRaysJumpSays) {
  const Scenery scenery(500);
  std::vector<uint32_t> support;
  FlowCapacities graph = scenery.VoteHalfBlind(&support);
  FlowCapacities expected = graph;
  std::vector<SupportJump> jumps;
  std::vector<uint32_t> fronts;
  scenery.ForEachRay(
      [&](uint32_t vertex, const Eigen::Vector3d& center, float /*alpha*/) {
        jumps.push_back(
            MeasureJump(scenery.tetrahedra, support, vertex, center, kOptions));
        if (jumps.back().end_cell != kNone) {
          fronts.push_back(jumps.back().front);
        }
      });
  std::ranges::sort(fronts);
  const double median = fronts[fronts.size() / 2];
  size_t num_sharp = 0;
  for (size_t k = 0; k < jumps.size(); ++k) {
    if (jumps[k].end_cell != kNone &&
        static_cast<double>(jumps[k].front) - jumps[k].behind > median / 2 &&
        jumps[k].behind < median / 100) {
      ++num_sharp;
      expected[jumps[k].end_cell].sink +=
          ToCapacity(2 * scenery.observations.values[k].alpha);
    }
  }
  EXPECT_EQ(AddWeakSurfaceWeights(scenery.tetrahedra, scenery.observations,
                                  scenery.centers, support, kOptions, &graph),
            num_sharp);
  EXPECT_TRUE(graph == expected);
  EXPECT_GT(num_sharp, 0u);
  EXPECT_LT(num_sharp, jumps.size());
}

TEST(WeakSurfaceWeights, DoNotDependOnThreads) {
  const Scenery scenery(1500);
  ExpectSameForAnyThreads([&] {
    std::vector<uint32_t> support;
    FlowCapacities graph = scenery.VoteHalfBlind(&support);
    AddWeakSurfaceWeights(scenery.tetrahedra, scenery.observations,
                          scenery.centers, support, kOptions, &graph);
    return std::pair(std::move(support), std::move(graph));
  });
}

// Asking for the free-space support changes no vote.
TEST(FreeSupport, LeavesTheVotesAsTheyAre) {
  const Scenery scenery(500);
  std::vector<uint32_t> support;
  EXPECT_TRUE(scenery.Vote(&support) == scenery.Vote(nullptr));
}

TEST(WeakSurfaceWeights, NeedNoRays) {
  const Scenery scenery(60);
  FlowCapacities graph = ZeroCapacities(scenery.tetrahedra);
  Observations none;
  none.offsets.resize(61, 0);
  EXPECT_EQ(AddWeakSurfaceWeights(scenery.tetrahedra, none, scenery.centers,
                                  std::vector<uint32_t>(graph.size(), 0),
                                  kOptions, &graph),
            0u);
}

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

}  // namespace colmap_ext::weak_surfaces_test
