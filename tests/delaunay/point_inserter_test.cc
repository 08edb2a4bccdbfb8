#include "delaunay/point_inserter.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "delaunay/growing_complex.h"
#include "delaunay/insert_points.h"
#include "tests/delaunay/random_complex.h"
#include "tests/random.h"

namespace colmap_ext {
namespace point_inserter_test {

// Points along the curve, the first hundred of their order inserted.
struct Begun {
  explicit Begun(std::vector<Eigen::Vector3f> positions) {
    std::vector<uint32_t> representatives;
    for (const uint32_t point : DistinctPoints(positions, &representatives)) {
      complex.points.push_back(positions[point]);
    }
    order = InsertionOrder(complex.points.size());
    StartComplex(order, &complex);
    PointInserter inserter(0, Size(), &complex);
    for (size_t i = 0; i < std::min<size_t>(100, order.size()); ++i) {
      InsertBy(order[i], &inserter);
    }
    GiveBack(inserter);
  }

  uint32_t Size() const { return static_cast<uint32_t>(complex.points.size()); }

  // \pre the inserter has all vertices
  void InsertBy(uint32_t point, PointInserter* inserter) {
    if (complex.vertex_cells[point] == kNone) {
      const uint32_t hint = complex.vertex_cells[order.front()];
      InsertPoint(point, inserter->Locate(point, hint), inserter, &complex);
    }
  }

  void GiveBack(PointInserter& inserter) {
    complex.free_cells.insert(complex.free_cells.end(),
                              inserter.free_cells().begin(),
                              inserter.free_cells().end());
    inserter.free_cells().clear();
  }

  GrowingComplex complex;
  std::vector<uint32_t> order;
};

// \return whether the point could be inserted
bool TryInsert(uint32_t point, uint32_t begin, uint32_t end,
               PointInserter* inserter, const GrowingComplex& complex) {
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
    const uint32_t hint = complex.vertex_cells[vertex];
    if (hint != kNone && inserter->IsOwn(hint)) {
      const uint32_t cell = inserter->Locate(point, hint);
      return cell != kNone && inserter->Insert(point, cell) != kNone;
    }
  }
  return false;
}

std::vector<NamedPoints> PointSets() {
  Random random(7);
  std::vector<NamedPoints> sets = DifficultPoints();
  sets.push_back({"many", RandomPoints(3000, 1 << 16, &random)});
  return sets;
}

TEST(PointInserter, ThoseOfTwoRangesMakeWhatOneMakes) {
  for (const auto& [name, points] : PointSets()) {
    SCOPED_TRACE(name);
    Begun expected(points);
    PointInserter all(0, expected.Size(), &expected.complex);
    for (const uint32_t point : expected.order) {
      expected.InsertBy(point, &all);
    }
    expected.GiveBack(all);

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
        const bool is_lower = point < middle;
        num_inserted += TryInsert(point, is_lower ? 0 : middle,
                                  is_lower ? middle : begun.Size(),
                                  is_lower ? &lower : &upper, begun.complex);
      }
    }
    if (name == "many") {
      EXPECT_GT(num_inserted, begun.Size() / 4);
    }
    begun.GiveBack(lower);
    begun.GiveBack(upper);
    PointInserter rest(0, begun.Size(), &begun.complex);
    for (const uint32_t point : begun.order) {
      begun.InsertBy(point, &rest);
    }
    begun.GiveBack(rest);

    std::vector<uint32_t> numbers(begun.Size());
    std::iota(numbers.begin(), numbers.end(), 0);
    const auto a = TakeTetrahedra(numbers, &begun.complex).cells;
    const auto b = TakeTetrahedra(numbers, &expected.complex).cells;
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].vertices, b[i].vertices);
      ASSERT_EQ(a[i].neighbors, b[i].neighbors);
    }
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

}  // namespace point_inserter_test
}  // namespace colmap_ext
