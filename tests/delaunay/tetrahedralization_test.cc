#include "delaunay/tetrahedralization.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

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
    PointInserter inserter(0, Size(), &complex);
    AddFreeCells(16 * count + 1000, &complex);
    inserter.free_cells().swap(complex.free_cells);
    for (size_t i = 0; i < std::min(count, order.size()); ++i) {
      if (complex.vertex_cells[order[i]] == kNone) {
        const uint32_t hint = complex.vertex_cells[order.front()];
        ASSERT_NE(inserter.Insert(order[i], inserter.Locate(order[i], hint)),
                  kNone);
      }
    }
    GiveBack(inserter);
  }

  void GiveBack(PointInserter& inserter) {
    Append(inserter.free_cells(), &complex.free_cells);
    inserter.free_cells().clear();
  }

  GrowingComplex complex;
  std::vector<uint32_t> order;
};

TEST(PointInserter, ThoseOfTwoRangesMakeWhatOneMakes) {
  Random random(7);
  std::vector<NamedPoints> sets = DifficultPoints();
  sets.push_back({"many", RandomPoints(3000, 1 << 16, &random)});
  for (const auto& [name, points] : sets) {
    SCOPED_TRACE(name);
    Begun expected(points);
    expected.InsertFirst(expected.Size());

    Begun begun(points);
    const uint32_t middle = begun.Size() / 2;
    PointInserter lower(0, middle, &begun.complex);
    PointInserter upper(middle, begun.Size(), &begun.complex);
    for (PointInserter* inserter : {&lower, &upper}) {
      AddFreeCells(40000, &begun.complex);
      std::swap(inserter->free_cells(), begun.complex.free_cells);
    }
    size_t num_inserted = 0;
    for (const uint32_t point : begun.order) {
      if (begun.complex.vertex_cells[point] == kNone) {
        PointInserter& inserter = point < middle ? lower : upper;
        const uint32_t hint = inserter.FindOwnCell();
        const uint32_t cell =
            hint != kNone ? inserter.Locate(point, hint) : kNone;
        num_inserted += cell != kNone && inserter.Insert(point, cell) != kNone;
      }
    }
    if (name == "many") {
      EXPECT_GT(num_inserted, begun.Size() / 4);
    }
    begun.GiveBack(lower);
    begun.GiveBack(upper);
    begun.InsertFirst(begun.Size());

    std::vector<uint32_t> numbers = Iota(begun.Size());
    EXPECT_TRUE(TakeTetrahedra(numbers, &begun.complex) ==
                TakeTetrahedra(numbers, &expected.complex));
  }
}

TEST(PointInserter, LeavesAllAsItIsWhereItHasTooFewCells) {
  Random random(8);
  Begun begun(RandomPoints(200, 1 << 16, &random));
  PointInserter inserter(0, begun.Size(), &begun.complex);
  for (const uint32_t point : begun.order) {
    if (begun.complex.vertex_cells[point] == kNone) {
      const uint32_t cell = inserter.Locate(
          point, begun.complex.vertex_cells[begun.order.front()]);
      EXPECT_EQ(inserter.Insert(point, cell), kNone);
      EXPECT_EQ(begun.complex.vertex_cells[point], kNone);
    }
  }
  EXPECT_EQ(std::ranges::count(begun.complex.is_marked, 0),
            static_cast<ptrdiff_t>(begun.complex.is_marked.size()));
}

}  // namespace colmap_ext::tetrahedralization_test
