#include "meshing/singular_vertices.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "meshing/fix_singular_vertices.h"
#include "tests/meshing/fixing_problem.h"
#include "tests/threads.h"

namespace colmap_ext::singular_vertices_test {

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
      return random.Below(problem.labels.size());
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

TEST(VertexStar, ComponentsAreTheConnectedCellsOfOneLabel) {
  Random random(3);
  const Tetrahedralization tetrahedra =
      DelaunayOf(RandomPoints(100, 1000, &random));
  const std::vector<uint8_t> random_labels = RandomLabels(tetrahedra, &random);
  const std::vector<uint8_t> one_label(random_labels.size(), 1);
  for (const std::vector<uint8_t>& labels : {random_labels, one_label}) {
    for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      VertexStar star;
      MakeVertexStar(tetrahedra, labels, vertex, &star);
      std::map<uint32_t, size_t> components;  // of cells
      uint32_t last_lowest = 0;
      for (size_t i = 0; i < star.NumComponents(); ++i) {
        const auto component = star.Component(i);
        ASSERT_FALSE(component.empty());
        for (const uint32_t cell : component) {
          ASSERT_EQ(labels[cell], star.is_free[i]);
          ASSERT_TRUE(components.emplace(cell, i).second);
        }
        ASSERT_EQ(component.front(), std::ranges::min(component));
        ASSERT_TRUE(i == 0 || component.front() > last_lowest);
        last_lowest = component.front();
      }
      std::vector<uint32_t> cells;
      IncidentCells(tetrahedra, vertex, &cells);
      ASSERT_EQ(components.size(), cells.size());
      // Cells on both sides of a facet with the vertex: one component just
      // where they have one label. That a component hangs together is in the
      // count.
      for (const uint32_t cell : cells) {
        for (int k = 0; k < 4; ++k) {
          const uint32_t neighbor = tetrahedra.cells[cell].neighbors[k];
          if (tetrahedra.cells[cell].vertices[k] != vertex) {
            ASSERT_EQ(components.at(cell) == components.at(neighbor),
                      labels[cell] == labels[neighbor]);
          }
        }
      }
    }
  }
}

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

}  // namespace colmap_ext::singular_vertices_test
