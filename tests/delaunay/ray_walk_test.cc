#include "delaunay/ray_walk.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext::ray_walk_test {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// A facet by its corners, sorted.
using Corners = std::array<uint32_t, 3>;

Corners CornersOf(const Tetrahedralization& tetrahedra, uint32_t arc) {
  return FacetOf(tetrahedra.cells[arc / 4], static_cast<int>(arc % 4));
}

// What holds for every walk.
void ExpectPath(const Tetrahedralization& tetrahedra, uint32_t origin,
                const RayPath& path) {
  const auto& [crossings, last_cell] = path;
  ASSERT_NE(last_cell, kNone);
  std::set<uint32_t> visited;
  for (size_t i = 0; i < crossings.size(); ++i) {
    const uint32_t cell = crossings[i].exit_arc / 4;
    const uint32_t next = crossings[i].entry_arc / 4;
    ASSERT_FALSE(tetrahedra.IsInfinite(cell));
    ASSERT_EQ(tetrahedra.cells[cell].neighbors[crossings[i].exit_arc % 4],
              next);
    ASSERT_EQ(tetrahedra.cells[next].neighbors[crossings[i].entry_arc % 4],
              cell);
    ASSERT_EQ(next, i + 1 < crossings.size() ? crossings[i + 1].exit_arc / 4
                                             : last_cell);
    ASSERT_TRUE(visited.insert(cell).second) << "a cell is entered twice";
    if (i > 0) {
      ASSERT_GE(crossings[i].distance, crossings[i - 1].distance * (1 - 1e-4f));
    } else {
      ASSERT_GE(crossings[i].distance, 0);
    }
  }
  if (crossings.empty()) {
    ASSERT_GT(std::ranges::count(tetrahedra.cells[last_cell].vertices, origin),
              0);
    return;
  }
  // Out through the facet opposite to the vertex.
  const uint32_t first = crossings.front().exit_arc;
  ASSERT_EQ(tetrahedra.cells[first / 4].vertices[first % 4], origin);
}

// On which sides of the edges of a triangle a line passes: the least and the
// greatest.
std::pair<int, int> TurnsAround(const std::array<IntVector, 3>& facet,
                                const IntVector& origin,
                                const IntVector& target) {
  const auto& [a, b, c] = facet;
  return std::minmax({ExactOrientation(origin, target, a, b),
                      ExactOrientation(origin, target, b, c),
                      ExactOrientation(origin, target, c, a)});
}

// Which facets the open segment crosses, exactly; nothing where it touches an
// edge, or a facet with its end.
std::optional<std::set<Corners>> CrossedFacets(
    const Tetrahedralization& tetrahedra, const IntVector& origin,
    const IntVector& target) {
  std::set<Corners> crossed;
  for (uint32_t arc = 0; arc < 4 * tetrahedra.cells.size(); ++arc) {
    const Corners corners = CornersOf(tetrahedra, arc);
    if (corners.back() == kInfiniteVertex || crossed.contains(corners)) {
      continue;
    }
    const auto facet = IntegersOf(tetrahedra.points, corners);
    const auto& [a, b, c] = facet;
    const int side = ExactOrientation(a, b, c, origin);
    const int other_side = ExactOrientation(a, b, c, target);
    if (side == 0 || side == other_side) {
      continue;
    }
    const auto [low, high] = TurnsAround(facet, origin, target);
    if (low * high < 0) {
      continue;
    }
    if (other_side == 0 || low == 0 || high == 0) {
      return std::nullopt;
    }
    crossed.insert(corners);
  }
  return crossed;
}

// Whether the closed segment touches the closed facet, or is in its plane.
bool Touches(const std::array<IntVector, 3>& facet, const IntVector& origin,
             const IntVector& target) {
  const auto& [a, b, c] = facet;
  if (ExactOrientation(a, b, c, origin) * ExactOrientation(a, b, c, target) >
      0) {
    return false;
  }
  const auto [low, high] = TurnsAround(facet, origin, target);
  return low * high >= 0;
}

// Whether the closed cell holds the point. The region of an infinite cell is
// what lies beyond the plane of its facet.
bool Holds(const Tetrahedralization& tetrahedra, uint32_t cell_index,
           const IntVector& point) {
  for (uint32_t i = 0; i < 4; ++i) {
    const auto vertices = FacetVertices(tetrahedra.cells[cell_index], i);
    if (std::ranges::find(vertices, kInfiniteVertex) != vertices.end()) {
      continue;
    }
    const auto [a, b, c] = IntegersOf(tetrahedra.points, vertices);
    if (ExactOrientation(a, b, c, point) < 0) {
      return false;
    }
  }
  return true;
}

std::set<Corners> FacetsOf(const Tetrahedralization& tetrahedra,
                           const RayPath& path) {
  std::set<Corners> facets;
  for (const Crossing& crossing : path.crossings) {
    facets.insert(CornersOf(tetrahedra, crossing.exit_arc));
  }
  return facets;
}

struct GenericRayWalk : testing::Test {
  static constexpr int kRange = 1 << 16;

  Eigen::Vector3d RandomTarget(int range) {
    return RandomPoints(1, range, &random_).front().cast<double>();
  }

  uint32_t RandomOrigin() { return random_.Below(tetrahedra_.points.size()); }

  Random random_{1};
  const Tetrahedralization tetrahedra_ =
      DelaunayOf(RandomPoints(100, kRange, &random_));
};

TEST_F(GenericRayWalk, CrossesTheFacetsThatBruteForceFinds) {
  size_t num_inside = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const uint32_t origin = RandomOrigin();
    const Eigen::Vector3d target = RandomTarget(2 * kRange);
    const auto expected = CrossedFacets(
        tetrahedra_, tetrahedra_.PositionOf(origin).cast<int64_t>(),
        target.cast<int64_t>());
    ASSERT_TRUE(expected.has_value());
    const RayPath path = PathOf(tetrahedra_, {origin, target});
    ExpectPath(tetrahedra_, origin, path);
    ASSERT_EQ(FacetsOf(tetrahedra_, path), *expected);
    if (!tetrahedra_.IsInfinite(path.end)) {
      ++num_inside;
      ASSERT_TRUE(Holds(tetrahedra_, path.end, target.cast<int64_t>()));
      // The same when the end is known.
      const RayPath to_end =
          PathOf(tetrahedra_, {origin, target, path.end, kEverywhere});
      ASSERT_EQ(to_end.end, path.end);
      ASSERT_EQ(to_end.crossings.size(), path.crossings.size());
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(num_inside, 100u);
}

TEST_F(GenericRayWalk, DistancesAreThoseOfTheFacetsPlanes) {
  for (int trial = 0; trial < 300; ++trial) {
    const uint32_t origin = RandomOrigin();
    const Eigen::Vector3d target = RandomTarget(2 * kRange);
    const RayPath path = PathOf(tetrahedra_, {origin, target});
    for (const Crossing& crossing : path.crossings) {
      const auto [a, b, c] = IntegersOf(
          tetrahedra_.points, CornersOf(tetrahedra_, crossing.exit_arc));
      const IntVector o = tetrahedra_.PositionOf(origin).cast<int64_t>();
      const IntVector t = target.cast<int64_t>();
      const auto before = static_cast<double>(Determinant(b - a, c - a, o - a));
      const auto after = static_cast<double>(Determinant(b - a, c - a, t - a));
      const double length = (target - tetrahedra_.PositionOf(origin)).norm();
      ASSERT_NEAR(crossing.distance, length * before / (before - after),
                  1e-6 * length);
    }
  }
}

TEST_F(GenericRayWalk, DistancesEndBeyondTheNearOnes) {
  constexpr double kNear = 0.3 * kRange;
  for (int trial = 0; trial < 300; ++trial) {
    const uint32_t origin = RandomOrigin();
    const Eigen::Vector3d target =
        4 * RandomTarget(kRange) - 3 * tetrahedra_.PositionOf(origin);
    // Through the hull, or to the target where it is the end.
    const auto no_cell = static_cast<uint32_t>(tetrahedra_.cells.size());
    const auto [all, hull] =
        PathOf(tetrahedra_, {origin, target, no_cell, kEverywhere});
    ASSERT_TRUE(tetrahedra_.IsInfinite(hull));
    const auto [near, end] =
        PathOf(tetrahedra_, {origin, target, no_cell, kNear});
    ASSERT_EQ(end, hull);
    ASSERT_EQ(near.size(), all.size());
    bool is_beyond = false;
    for (size_t i = 0; i < near.size(); ++i) {
      ASSERT_EQ(near[i].exit_arc, all[i].exit_arc);
      ASSERT_EQ(near[i].distance, is_beyond ? kEverywhere : all[i].distance);
      is_beyond |= all[i].distance > kNear;
    }
  }
}

TEST_F(GenericRayWalk, TheWayBackCrossesTheSameFacets) {
  const auto num_points = static_cast<uint32_t>(tetrahedra_.points.size());
  for (uint32_t u = 0; u < num_points; ++u) {
    const uint32_t v = random_.Below(num_points);
    if (u == v) {
      continue;
    }
    std::array<std::set<Corners>, 2> facets;
    for (const bool is_back : {false, true}) {
      const uint32_t origin = is_back ? v : u;
      const uint32_t end = is_back ? u : v;
      const RayPath path =
          PathOf(tetrahedra_, {origin, tetrahedra_.PositionOf(end)});
      ExpectPath(tetrahedra_, origin, path);
      facets[is_back] = FacetsOf(tetrahedra_, path);
      // Facets that meet at the end may or may not be crossed.
      std::erase_if(facets[is_back], [&](const Corners& corners) {
        return std::ranges::find(corners, end) != corners.end();
      });
    }
    ASSERT_EQ(facets[0], facets[1]);
  }
}

// Rays through vertices, along edges and within facets.
TEST(DegenerateRayWalk, EndsWhereTheTargetIs) {
  Random random(2);
  size_t num_degenerate = 0;
  size_t num_given_up = 0;
  for (const auto& [name, points] : EvenDifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (int trial = 0; trial < 400; ++trial) {
      const uint32_t origin = random.Below(tetrahedra.points.size());
      const Eigen::Vector3d a = AnyPoint(tetrahedra, &random);
      const Eigen::Vector3d b = AnyPoint(tetrahedra, &random);
      Eigen::Vector3d target = a;  // another vertex
      switch (random.Below(4)) {
        case 0:
          break;
        case 1:  // on an edge, within a facet or between
          target = 0.5 * (a + b);
          break;
        case 2:  // parallel to an axis, beyond the hull
          target = tetrahedra.PositionOf(origin);
          target[random.Below(3)] += random.Chance(0.5) ? 10000 : -10000;
          break;
        default:  // through another vertex, and beyond
          target = 3 * a - 2 * tetrahedra.PositionOf(origin);
      }
      const RayPath path = PathOf(tetrahedra, {origin, target});
      const IntVector o = tetrahedra.PositionOf(origin).cast<int64_t>();
      const IntVector t = target.cast<int64_t>();
      if (o == t) {
        ASSERT_EQ(path.end, kNone);
        ++num_given_up;
        continue;
      }
      num_degenerate += !CrossedFacets(tetrahedra, o, t).has_value();
      ExpectPath(tetrahedra, origin, path);
      ASSERT_FALSE(testing::Test::HasFailure());
      if (!tetrahedra.IsInfinite(path.end)) {
        ASSERT_TRUE(Holds(tetrahedra, path.end, t));
      }
      for (const Crossing& crossing : path.crossings) {
        ASSERT_TRUE(
            Touches(IntegersOf(tetrahedra.points,
                               CornersOf(tetrahedra, crossing.exit_arc)),
                    o, t));
      }
    }
  }
  EXPECT_GT(num_degenerate, 1000u);
  EXPECT_GT(num_given_up, 0u);
}

// All turns are exact: a cell that strictly holds the target is found, whatever
// the coordinates are.
TEST(DegenerateRayWalk, FindsTheCellThatHoldsTheTarget) {
  Random random(3);
  std::vector<NamedPoints> sets = DifficultPoints();
  for (auto& [name, points] : sets) {
    for (Eigen::Vector3f& point : points) {
      // Not as exact as before, and far from the origin: nearly degenerate.
      point = 0.1f * point + Eigen::Vector3f(1000, 2000, -3000);
    }
  }
  for (const auto& [name, points] : sets) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (int trial = 0; trial < 500; ++trial) {
      const uint32_t cell = random.Below(tetrahedra.cells.size());
      if (tetrahedra.IsInfinite(cell)) {
        continue;
      }
      Eigen::Vector3d target = Eigen::Vector3d::Zero();
      double sum = 0;
      for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
        const double weight = random.Chance(0.3) ? 1e-7 : random.Unit();
        target += weight * tetrahedra.points[vertex].cast<double>();
        sum += weight;
      }
      target /= sum;
      if (!IsStrictlyInside(tetrahedra, cell, target)) {
        continue;
      }
      const uint32_t vertex = random.Below(tetrahedra.points.size());
      ASSERT_EQ(Locate(tetrahedra, target, tetrahedra.vertex_cells[vertex]),
                cell);
      ASSERT_EQ(PathOf(tetrahedra, {vertex, target, cell}).end, cell);
    }
  }
}

TEST(Locate, FindsACellThatHoldsThePoint) {
  Random random(4);
  for (const auto& [name, points] : EvenDifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (int trial = 0; trial < 400; ++trial) {
      const Eigen::Vector3d a = AnyPoint(tetrahedra, &random);
      const Eigen::Vector3d b = AnyPoint(tetrahedra, &random);
      const Eigen::Vector3d position =
          random.Chance(0.5) ? (0.5 * (a + b)).eval() : (2 * a - b).eval();
      const IntVector point = position.cast<int64_t>();
      const uint32_t vertex = random.Below(tetrahedra.points.size());
      const uint32_t cell =
          Locate(tetrahedra, position, tetrahedra.vertex_cells[vertex]);
      ASSERT_TRUE(Holds(tetrahedra, cell, point));
      if (tetrahedra.IsInfinite(cell)) {
        // Beyond the hull, not on it.
        for (uint32_t other = 0; other < tetrahedra.cells.size(); ++other) {
          ASSERT_TRUE(tetrahedra.IsInfinite(other) ||
                      !Holds(tetrahedra, other, point));
        }
      }
    }
  }
}

// Whether the way from the origin to the target leaves a finite cell that holds
// the origin at once.
bool LeavesAtOnce(const Tetrahedralization& tetrahedra, uint32_t cell,
                  const IntVector& origin, const IntVector& target) {
  for (uint32_t i = 0; i < 4; ++i) {
    const auto [a, b, c] =
        IntegersOf(tetrahedra.points, FacetVertices(tetrahedra.cells[cell], i));
    if (ExactOrientation(a, b, c, origin) == 0 &&
        ExactOrientation(a, b, c, target) < 0) {
      return true;
    }
  }
  return false;
}

// Origins on facets and edges, and at vertices; targets in their planes, too.
TEST(EnteredCell, IsOneOfThoseThatHoldTheOriginWhicheverIsKnown) {
  Random random(5);
  size_t num_shared = 0;
  for (const auto& [name, points] : EvenDifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    const auto any = [&] { return AnyPoint(tetrahedra, &random); };
    for (int trial = 0; trial < 60; ++trial) {
      const Eigen::Vector3d origin = 0.5 * (any() + any());
      const Eigen::Vector3d target =
          trial % 4 == 0 ? origin : (2 * any() - any()).eval();
      const IntVector o = origin.cast<int64_t>();
      const IntVector t = target.cast<int64_t>();
      std::set<uint32_t> entered;  // those that are finite
      size_t num_cells = 0;
      size_t num_infinite = 0;
      for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
        if (!tetrahedra.IsInfinite(cell) && Holds(tetrahedra, cell, o)) {
          ++num_cells;
          const uint32_t found = EnteredCell(tetrahedra, cell, origin, target);
          if (tetrahedra.IsInfinite(found)) {
            ++num_infinite;
          } else {
            entered.insert(found);
          }
        }
      }
      num_shared += num_cells > 1;
      ASSERT_TRUE(num_infinite == 0 || num_infinite == num_cells);
      ASSERT_EQ(entered.size(), num_infinite == 0 ? 1u : 0u);
      for (const uint32_t cell : entered) {
        ASSERT_TRUE(Holds(tetrahedra, cell, o));
        ASSERT_FALSE(LeavesAtOnce(tetrahedra, cell, o, t));
      }
    }
  }
  EXPECT_GT(num_shared, 200u);
}

TEST(IsStrictlyInside, IsFalseOnTheFacets) {
  const Tetrahedralization tetrahedra =
      DelaunayOf({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}});
  const uint32_t cell = tetrahedra.vertex_cells[0];
  EXPECT_TRUE(IsStrictlyInside(tetrahedra, cell, {1, 1, 1}));
  EXPECT_TRUE(IsStrictlyInside(tetrahedra, cell, {1e-300, 1, 1}));
  const std::vector<Eigen::Vector3d> outside = {
      {0, 1, 1}, {2, 1, 1},  {0, 0, 0}, {0, 0, 2},
      {2, 2, 0}, {-1, 1, 1}, {2, 2, 1}, {1, 1, 2.0000000000000004}};
  for (const Eigen::Vector3d& point : outside) {
    EXPECT_FALSE(IsStrictlyInside(tetrahedra, cell, point));
  }
}

}  // namespace colmap_ext::ray_walk_test
