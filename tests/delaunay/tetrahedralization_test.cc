#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "delaunay/growing_complex.h"
#include "tests/delaunay/random_complex.h"
#include "tests/threads.h"

namespace colmap_ext::tetrahedralization_test {

TEST(Tetrahedralization, IsAClosedDelaunayComplexWithAConvexHull) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    EXPECT_EQ(DefectOf(tetrahedra, true), "");
    for (const auto& cell : tetrahedra.cells) {
      const auto& vertices = cell.vertices;
      const auto infinite = std::ranges::find(vertices, kInfiniteVertex);
      if (infinite == vertices.end()) {
        const auto [a, b, c, d] = IntegersOf(tetrahedra.points, vertices);
        for (const Eigen::Vector3f& point : tetrahedra.points) {
          ASSERT_LE(ExactInSphere(a, b, c, d, ToIntegers(point)), 0);
        }
        continue;
      }
      // The infinite cell's hull facet, seen from without.
      const auto facet =
          FacetVertices(cell, static_cast<int>(infinite - vertices.begin()));
      const auto [a, b, c] = IntegersOf(tetrahedra.points, facet);
      for (const Eigen::Vector3f& point : tetrahedra.points) {
        ASSERT_LE(ExactOrientation(a, b, c, ToIntegers(point)), 0);
      }
    }
  }
}

TEST(Tetrahedralization, DependsOnThePositionsAlone) {
  Random random(2);
  std::vector<NamedPoints> sets = DifficultPoints();
  sets.push_back({"many", RandomPoints(20000, 1 << 18, &random)});
  sets.push_back({"large grid", GridPoints(16)});
  for (auto& [name, points] : sets) {
    SCOPED_TRACE(name);
    ExpectSameForAnyThreads([&, &all = points] { return DelaunayOf(all); });
    std::vector<Eigen::Vector3f> shuffled = points;
    shuffled.insert(shuffled.end(), points.begin(),
                    points.begin() + static_cast<int>(points.size() / 3));
    random.Shuffle(&shuffled);
    EXPECT_TRUE(DelaunayOf(shuffled) == DelaunayOf(points));
  }
}

TEST(Tetrahedralization, RefusesWhatSpansNoVolume) {
  std::vector<Eigen::Vector3f> plane;
  for (int i = 0; i < 50; ++i) {
    plane.emplace_back(i % 7, i / 7, i % 7 - i / 7);
  }
  const std::vector<Eigen::Vector3f> line = {
      {0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {4, 8, 12}};
  for (const auto& points :
       {plane, line, std::vector<Eigen::Vector3f>(9, {1, 2, 3}),
        std::vector<Eigen::Vector3f>{},
        std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        // The fourth is at another's position.
        std::vector<Eigen::Vector3f>{
            {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}}}) {
    EXPECT_THROW(DelaunayOf(points), std::invalid_argument);
  }
}

TEST(Tetrahedralization, TellsZerosOfEitherSignNotApart) {
  std::vector<Eigen::Vector3f> points = GridPoints(3);
  const Tetrahedralization expected = DelaunayOf(points);
  points.emplace_back(-0.0f, 0.0f, -0.0f);
  EXPECT_TRUE(DelaunayOf(points) == expected);
}

TEST(IncidentCells, AreAllThatHaveTheVertex) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    std::vector<std::vector<uint32_t>> expected(tetrahedra.points.size());
    size_t most = 0;
    for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
      for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
        if (vertex != kInfiniteVertex) {
          expected[vertex].push_back(cell);
          most = std::max(most, expected[vertex].size());
        }
      }
    }
    if (name == "cone") {
      EXPECT_GT(most, 200u);
    }
    std::vector<uint32_t> cells = {1, 2, 3};  // of the last call
    for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
      IncidentCells(tetrahedra, vertex, &cells);
      std::ranges::sort(cells);
      ASSERT_EQ(cells, expected[vertex]);
    }
  }
}

TEST(CellPlaces, AreThoseOfAMap) {
  Random random(1);
  CellPlaces places;
  size_t num_repeats = 0;
  for (const uint32_t num_cells : {1, 5, 63, 64, 65, 3000, 20, 1}) {
    places.Clear();
    std::vector<uint32_t> cells;
    std::map<uint32_t, uint32_t> expected;
    for (uint32_t step = 0; step < 3 * num_cells; ++step) {
      // Also those that differ in their upper bits alone.
      const uint32_t cell = random.Below(num_cells) << random.Below(24);
      const auto [entry, is_new] =
          expected.try_emplace(cell, static_cast<uint32_t>(cells.size()));
      ASSERT_EQ(places.PlaceIn(cell, &cells), entry->second);
      ASSERT_EQ(cells.size(), expected.size());
      ASSERT_EQ(cells[entry->second], cell);
      num_repeats += !is_new;
    }
  }
  EXPECT_GT(num_repeats, 100u);
}

TEST(EdgeLengths, AreThoseOfEveryFiniteEdgeOnce) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (const auto& cell : tetrahedra.cells) {
      for (const uint32_t u : cell.vertices) {
        for (const uint32_t v : cell.vertices) {
          if (u < v && v != kInfiniteVertex) {
            edges.emplace(u, v);
          }
        }
      }
    }
    std::vector<float> lengths;
    for (const auto& [u, v] : edges) {
      lengths.push_back((tetrahedra.points[u] - tetrahedra.points[v]).norm());
    }
    std::ranges::sort(lengths);
    std::vector<float> found = EdgeLengths(tetrahedra);
    std::ranges::sort(found);
    EXPECT_EQ(found, lengths);
    std::vector<uint8_t> is_left_out(tetrahedra.points.size(), 1);
    EXPECT_TRUE(EdgeLengths(tetrahedra, is_left_out).empty());
    is_left_out.front() = 0;  // A vertex alone has no edge.
    EXPECT_TRUE(EdgeLengths(tetrahedra, is_left_out).empty());
  }
}

// Points along the curve, the first hundred of their order inserted.
struct Begun {
  explicit Begun(std::vector<Eigen::Vector3f> positions) {
    std::vector<uint32_t> representatives;
    for (const uint32_t point : DistinctPoints(positions, &representatives)) {
      complex.points.push_back(positions[point]);
    }
    order = InsertionOrder(complex.points.size());
    StartComplex(order, &complex);
    InsertFirst(100);
  }

  uint32_t Size() const { return static_cast<uint32_t>(complex.points.size()); }

  // Inserts what is missing of the first points.
  void InsertFirst(size_t count) {
    PointInserter inserter(0, &complex);
    AddFreeCells(16 * count + 1000, &complex);
    inserter.free_cells().swap(complex.free_cells);
    for (size_t i = 0; i < std::min(count, order.size()); ++i) {
      ASSERT_TRUE(inserter.Insert(order[i]));
    }
    GiveBack(inserter);
  }

  void GiveBack(PointInserter& inserter) {
    Append(inserter.free_cells(), &complex.free_cells);
    inserter.free_cells().clear();
  }

  // Cells in use are unlocked, and others are not in use.
  void ExpectNoLocks() const {
    std::vector<uint16_t> expected(complex.cells.size(),
                                   GrowingComplex::kUnlocked);
    for (const uint32_t cell : complex.free_cells) {
      expected[cell] = GrowingComplex::kNotInUse;
    }
    EXPECT_EQ(complex.locks, expected);
  }

  GrowingComplex complex;
  std::vector<uint32_t> order;
};

TEST(PointInserter, LeavesCellsThatAnotherOneHolds) {
  Random random(7);
  std::vector<NamedPoints> sets = DifficultPoints();
  sets.push_back({"many", RandomPoints(3000, 1 << 16, &random)});
  for (const auto& [name, points] : sets) {
    SCOPED_TRACE(name);
    Begun expected(points);
    expected.InsertFirst(expected.Size());

    // Another one holds some cells.
    Begun begun(points);
    AddFreeCells(40000, &begun.complex);
    PointInserter inserter(3, &begun.complex);
    inserter.free_cells().swap(begun.complex.free_cells);
    std::vector<std::pair<uint32_t, GrowingComplex::Cell>> held;
    for (uint32_t cell = 0; cell < begun.complex.cells.size(); cell += 200) {
      if (begun.complex.locks[cell] == GrowingComplex::kUnlocked) {
        held.emplace_back(cell, begun.complex.cells[cell]);
        begun.complex.locks[cell] = 1;
      }
    }
    size_t num_inserted = 0;
    for (const uint32_t point : begun.order) {
      num_inserted += inserter.Insert(point);
    }
    for (const auto& [cell, before] : held) {
      EXPECT_EQ(begun.complex.locks[cell], 1);
      EXPECT_EQ(begun.complex.cells[cell].vertices, before.vertices);
      EXPECT_EQ(begun.complex.cells[cell].mirror_facets, before.mirror_facets);
      begun.complex.locks[cell] = GrowingComplex::kUnlocked;
    }
    if (name == "many") {
      EXPECT_GT(num_inserted, begun.Size() / 4);
      EXPECT_LT(num_inserted, begun.Size() - 10);
    }
    begun.GiveBack(inserter);
    begun.ExpectNoLocks();
    begun.InsertFirst(begun.Size());
    begun.ExpectNoLocks();

    std::vector<uint32_t> numbers = Iota(begun.Size());
    EXPECT_TRUE(TakeTetrahedra(numbers, &begun.complex) ==
                TakeTetrahedra(numbers, &expected.complex));
  }
}

TEST(PointInserter, LeavesAllAsItIsWhereItHasTooFewCells) {
  Random random(8);
  Begun begun(RandomPoints(200, 1 << 16, &random));
  PointInserter inserter(0, &begun.complex);
  for (const uint32_t point : begun.order) {
    if (begun.complex.vertex_cells[point] == kNone) {
      EXPECT_FALSE(inserter.Insert(point));
      EXPECT_EQ(begun.complex.vertex_cells[point], kNone);
    }
  }
  begun.ExpectNoLocks();
}

TEST(InsertPoints, ManyThreadsInEachOthersWay) {
  // All stars of points on a line and a circle around it overlap.
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 5000; ++i) {
    points.emplace_back(0, 0, i);
  }
  for (int i = 0; i < 30; ++i) {
    const float angle = static_cast<float>(i) * 0.2f;
    points.emplace_back(5000 * std::cos(angle), 5000 * std::sin(angle), 2500);
  }
  const Tetrahedralization expected = DelaunayOf(points);
  const tbb::global_control control(
      tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena(8).execute(
      [&] { EXPECT_TRUE(DelaunayOf(points) == expected); });
}

}  // namespace colmap_ext::tetrahedralization_test
