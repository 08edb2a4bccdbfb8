#include "meshing/singular_vertices.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "meshing/manifold_fixing.h"
#include "meshing/surface_extraction.h"
#include "tests/delaunay/random_complex.h"
#include "tests/meshing/fixing_problem.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace singular_vertices_test {

using Link = std::map<uint32_t, std::set<uint32_t>>;  // of each vertex, others

// Around each vertex, the edges of the facets between free space and matter,
// those at infinity included.
std::vector<Link> BoundaryLinks(const Tetrahedralization& tetrahedra,
                                const std::vector<uint8_t>& is_free) {
  std::vector<Link> links(tetrahedra.points.size());
  for (size_t index = 0; index < tetrahedra.cells.size(); ++index) {
    const auto& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4; ++i) {
      if (is_free[index] == is_free[cell.neighbors[i]]) {
        continue;
      }
      const auto facet = FacetVertices(cell, i);
      for (int k = 0; k < 3; ++k) {
        const uint32_t vertex = facet[k];
        const uint32_t next = facet[(k + 1) % 3];
        const uint32_t last = facet[(k + 2) % 3];
        if (vertex != kInfiniteVertex) {
          links[vertex][next].insert(last);
          links[vertex][last].insert(next);
        }
      }
    }
  }
  return links;
}

// Whether there is no boundary around the vertex, or one fan: each neighbor has
// two facets, and all hang together.
bool IsRegular(const Link& link) {
  if (link.empty()) {
    return true;
  }
  std::set<uint32_t> reached = {link.begin()->first};
  std::vector<uint32_t> stack = {link.begin()->first};
  while (!stack.empty()) {
    const std::set<uint32_t>& others = link.at(stack.back());
    stack.pop_back();
    if (others.size() != 2) {
      return false;
    }
    for (const uint32_t other : others) {
      if (reached.insert(other).second) {
        stack.push_back(other);
      }
    }
  }
  return reached.size() == link.size();
}

TEST(SingularVertices, AreThoseWhereTheSurfaceIsNotOneFan) {
  Random random(1);
  size_t num_singular = 0;
  size_t num_regular = 0;
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (int trial = 0; trial < 40; ++trial) {
      std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
      if (random.Chance(0.3)) {
        LabelInfinite(tetrahedra, true, &labels);
      }
      const std::vector<Link> links = BoundaryLinks(tetrahedra, labels);
      std::vector<uint32_t> expected;
      for (uint32_t vertex = 0; vertex < links.size(); ++vertex) {
        const bool is_singular = !IsRegular(links[vertex]);
        VertexStar star;
        MakeVertexStar(tetrahedra, labels, vertex, &star);
        ASSERT_EQ(star.IsSingular(), is_singular);
        if (is_singular) {
          expected.push_back(vertex);
        }
        num_regular += !is_singular && !links[vertex].empty();
      }
      ASSERT_EQ(SingularVertices(tetrahedra, labels), expected);
      num_singular += expected.size();
    }
  }
  EXPECT_GT(num_singular, 1000u);
  EXPECT_GT(num_regular, 1000u);
}

// Where space beyond the hull is free, the surface tells by itself.
TEST(SingularVertices, AreThoseOfTheSurface) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Tetrahedralization tetrahedra =
        DelaunayOf(RandomPoints(5 + random.Below(40), 50, &random));
    std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
    LabelInfinite(tetrahedra, true, &labels);
    const MeshReport report = Analyze(ExtractSurface(tetrahedra, labels).mesh);
    ASSERT_EQ(SingularVertices(tetrahedra, labels).size(),
              report.num_singular_vertices);
  }
}

TEST(SingularVertices, AreNoneWithinOneLabel) {
  const Tetrahedralization tetrahedra = DelaunayOf(GridPoints(3));
  for (const uint8_t label : {0, 1}) {
    const std::vector<uint8_t> labels(tetrahedra.cells.size(), label);
    EXPECT_TRUE(SingularVertices(tetrahedra, labels).empty());
  }
}

TEST(SingularVertices, AreTheSameAtEveryNumberOfThreads) {
  Random random(4);
  // More cells than one thread takes at a time.
  const Tetrahedralization tetrahedra =
      DelaunayOf(RandomPoints(10000, 1 << 20, &random));
  const std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
  EXPECT_FALSE(SingularVertices(tetrahedra, labels).empty());
  ExpectSameForAnyThreads([&] { return SingularVertices(tetrahedra, labels); });
}

TEST(SingularVertexTracker, FollowsFlipsSplitsAndUndoneFlips) {
  Random random(5);
  size_t num_singular = 0;
  for (int trial = 0; trial < 100; ++trial) {
    FixingProblem problem = RandomProblem(
        RandomPoints(10 + random.Below(40), 1000, &random), &random);
    SingularVertexTracker tracker(problem.tetrahedra, &problem.labels);
    std::vector<uint8_t> labels = problem.labels;
    size_t num_flips = 0;
    const auto random_cell = [&] {
      return random.Below(static_cast<uint32_t>(problem.labels.size()));
    };
    for (int step = 0; step < 60; ++step) {
      const uint32_t kind = random.Below(8);
      if (kind < 5) {
        const uint32_t cell = random_cell();
        tracker.Flip({{cell, random_cell(), cell}});
      } else if (kind < 6) {
        tracker.UndoFlips(num_flips);
        ASSERT_EQ(problem.labels, labels);
      } else if (const uint32_t cell = random_cell();
                 !problem.tetrahedra.IsInfinite(cell)) {
        SplitCell(cell, &problem.tetrahedra, &problem.graph, &problem.labels);
        labels = problem.labels;
        num_flips = tracker.num_flips();
      }
      if (random.Chance(0.5)) {
        ASSERT_EQ(tracker.Singular(), problem.Singular());
        num_singular += tracker.Singular().size();
      }
    }
  }
  EXPECT_GT(num_singular, 1000u);
}

TEST(SingularVertexTracker, ExaminesTheVerticesOfFlippedCellsAlone) {
  Random random(6);
  FixingProblem problem =
      RandomProblem(RandomPoints(200, 1000, &random), &random);
  SingularVertexTracker tracker(problem.tetrahedra, &problem.labels);
  const size_t num_vertices = problem.tetrahedra.points.size();
  EXPECT_EQ(tracker.num_examined_vertices(), num_vertices);
  tracker.Singular();
  EXPECT_EQ(tracker.num_examined_vertices(), num_vertices);
  uint32_t cell = 0;
  while (problem.tetrahedra.IsInfinite(cell)) {
    ++cell;
  }
  for (const size_t num_examined : {4, 8}) {
    tracker.Flip({{cell}});
    tracker.Singular();
    EXPECT_EQ(tracker.num_examined_vertices(), num_vertices + num_examined);
  }
}

}  // namespace singular_vertices_test
}  // namespace colmap_ext
