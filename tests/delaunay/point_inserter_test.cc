#include "delaunay/growing_complex.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

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
    InsertFirst(100);
  }

  uint32_t Size() const { return static_cast<uint32_t>(complex.points.size()); }

  // Inserts what is missing of the first points.
  void InsertFirst(size_t count) {
    PointInserter inserter(0, Size(), &complex);
    for (size_t i = 0; i < std::min(count, order.size()); ++i) {
      if (complex.vertex_cells[order[i]] == kNone) {
        const uint32_t hint = complex.vertex_cells[order.front()];
        InsertPoint(order[i], inserter.Locate(order[i], hint), &inserter,
                    &complex);
      }
    }
    GiveBack(inserter);
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

    std::vector<uint32_t> numbers(begun.Size());
    std::iota(numbers.begin(), numbers.end(), 0);
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

}  // namespace point_inserter_test
}  // namespace colmap_ext
