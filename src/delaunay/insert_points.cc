#include "delaunay/growing_complex.h"

#include <algorithm>
#include <bit>
#include <mutex>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "base/mix_bits.h"
#include "base/rows.h"
#include "mesh/space_filling_curve.h"

namespace colmap_ext {
namespace {

// Cells for each point: a little more than the 6.8 of uniform random points,
// which have more than those of a surface.
constexpr size_t kCellsPerPoint = 7;

// Spare cells of an inserter, for the current insertion and for vertices with
// more cells than usual.
constexpr size_t kSpareCells = 4096;

// Points of a part that are worth a thread.
constexpr size_t kMinPartPoints = 2048;

using PointIndices = std::span<const uint32_t>;

// Reports how many of all points are inserted, by threads at once.
class InsertionProgress {
 public:
  InsertionProgress(size_t num_points, const Progress& progress)
      : num_points_(num_points), progress_(progress) {}

  // To be called for each point of a thread: every so many are reported.
  // \param num_inserted  by the thread
  void Count(size_t num_inserted) {
    constexpr size_t kStep = 16384;
    if (num_inserted % kStep == 0) {
      const std::lock_guard lock(mutex_);
      num_done_ += kStep;
      Report(progress_, kTriangulatingStage,
             static_cast<double>(num_done_) / static_cast<double>(num_points_));
    }
  }

 private:
  size_t num_points_;
  const Progress& progress_;
  std::mutex mutex_;
  size_t num_done_ = 0;
};

// A range of vertices, and what of a round lies in it, ascending.
struct Part {
  PointInserter inserter;
  PointIndices points;
  std::vector<uint32_t> left_over;  // points that it could not insert
};

void MoveCells(size_t num_cells, std::vector<uint32_t>* from,
               std::vector<uint32_t>* to) {
  const size_t kept = from->size() - std::min(num_cells, from->size());
  to->insert(to->end(), from->begin() + static_cast<ptrdiff_t>(kept),
             from->end());
  from->resize(kept);
}

void InsertPart(const GrowingComplex& complex, InsertionProgress* progress,
                Part* part) {
  size_t num_inserted = 0;
  uint32_t hint = part->inserter.FindOwnCell();
  for (const uint32_t point : part->points) {
    if (complex.vertex_cells[point] != kNone) {
      continue;
    }
    const uint32_t cell =
        hint != kNone ? part->inserter.Locate(point, hint) : kNone;
    const uint32_t inserted =
        cell != kNone ? part->inserter.Insert(point, cell) : kNone;
    if (inserted != kNone) {
      hint = inserted;
      progress->Count(++num_inserted);
    } else {
      part->left_over.push_back(point);
    }
  }
}

// \param borders  of the parts: ascending, from 0 to the number of points
// \return the points that could not be inserted, ascending
std::vector<uint32_t> InsertInParts(PointIndices points,
                                    const std::vector<uint32_t>& borders,
                                    InsertionProgress* progress,
                                    GrowingComplex* complex) {
  const size_t num_parts = borders.size() - 1;
  const size_t num_cells =
      kCellsPerPoint * points.size() + kSpareCells * num_parts;
  if (complex->free_cells.size() < num_cells) {
    AddFreeCells(num_cells - complex->free_cells.size(), complex);
  }
  std::vector<Part> parts;
  for (size_t i = 0; i < num_parts; ++i) {
    const auto begin = std::ranges::lower_bound(points, borders[i]);
    const auto end = std::ranges::lower_bound(points, borders[i + 1]);
    parts.push_back({PointInserter(borders[i], borders[i + 1], complex),
                     PointIndices(begin, end),
                     {}});
    MoveCells(kCellsPerPoint * parts[i].points.size() + kSpareCells,
              &complex->free_cells, &parts[i].inserter.free_cells());
  }
  tbb::parallel_for(size_t{0}, num_parts, [&](size_t i) {
    InsertPart(*complex, progress, &parts[i]);
  });
  std::vector<uint32_t> left_over;
  for (Part& part : parts) {
    std::vector<uint32_t>& cells = part.inserter.free_cells();
    MoveCells(cells.size(), &cells, &complex->free_cells);
    Append(part.left_over, &left_over);
  }
  return left_over;
}

// \param shift  of the borders, in parts
std::vector<uint32_t> Borders(size_t num_points, size_t num_parts,
                              double shift) {
  std::vector<uint32_t> borders = {0};
  const double size =
      static_cast<double>(num_points) / static_cast<double>(num_parts);
  for (size_t i = 0; i < num_parts; ++i) {
    const auto border =
        static_cast<uint32_t>((static_cast<double>(i) + shift) * size);
    if (border > borders.back()) {
      borders.push_back(border);
    }
  }
  borders.push_back(static_cast<uint32_t>(num_points));
  return borders;
}

void InsertSerially(PointIndices points, InsertionProgress* progress,
                    GrowingComplex* complex) {
  const auto num_points = static_cast<uint32_t>(complex->points.size());
  PointInserter inserter(0, num_points, complex);
  inserter.free_cells().swap(complex->free_cells);
  uint32_t hint = inserter.FindOwnCell();
  size_t num_done = 0;
  for (const uint32_t point : points) {
    progress->Count(++num_done);
    while (complex->vertex_cells[point] == kNone) {
      const uint32_t inserted =
          inserter.Insert(point, inserter.Locate(point, hint));
      if (inserted != kNone) {
        hint = inserted;
      } else {  // Too few cells are free.
        AddFreeCells(kSpareCells, complex);
        MoveCells(kSpareCells, &complex->free_cells, &inserter.free_cells());
      }
    }
  }
  inserter.free_cells().swap(complex->free_cells);
}

// What lies at a border of the parts is tried again in parts with other
// borders, before it is inserted by one thread.
void InsertRound(PointIndices points, InsertionProgress* progress,
                 GrowingComplex* complex) {
  std::vector<uint32_t> left_over(points.begin(), points.end());
  for (const double shift : {0.0, 0.5}) {
    const size_t num_parts =
        std::min<size_t>(tbb::this_task_arena::max_concurrency(),
                         left_over.size() / kMinPartPoints);
    if (num_parts > 1) {
      left_over = InsertInParts(
          left_over, Borders(complex->points.size(), num_parts, shift),
          progress, complex);
    }
  }
  InsertSerially(left_over, progress, complex);
}

}  // namespace

std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives) {
  ExpectIndexable(positions.size(), "points");
  std::vector<uint32_t> points = OrderAlongCurve(positions);
  representatives->resize(positions.size());
  size_t size = 0;
  for (const uint32_t point : points) {
    if (size == 0 || positions[points[size - 1]] != positions[point]) {
      points[size++] = point;
    }
    (*representatives)[point] = points[size - 1];
  }
  points.resize(size);
  return points;
}

std::vector<uint32_t> InsertionOrder(size_t num_points) {
  // A point is in round k with probability 2^-(k + 1): its number of SplitMix64
  // starts with k zero bits.
  constexpr int kNumRounds = 64;
  const auto round_from_last = [](size_t point) {
    const uint64_t hash = MixBits((point + 1) * kSplitMixStep) | 1;
    return static_cast<size_t>(kNumRounds - 1 - std::countl_zero(hash));
  };
  return GroupInRows<uint32_t>(
             kNumRounds,
             [&](const auto& add) {
               for (size_t point = 0; point < num_points; ++point) {
                 add(round_from_last(point), static_cast<uint32_t>(point));
               }
             })
      .values;
}

void InsertPoints(const std::vector<uint32_t>& order, const Progress& progress,
                  GrowingComplex* complex) {
  complex->cells.reserve(kCellsPerPoint * order.size() + kSpareCells);
  StartComplex(order, complex);
  InsertionProgress inserted(order.size(), progress);
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::is_sorted_until(begin, order.end());
    InsertRound(PointIndices(begin, end), &inserted, complex);
    begin = end;
  }
}

void InsertMorePoints(std::span<const Eigen::Vector3f> positions,
                      GrowingComplex* complex) {
  const std::vector<uint32_t> added =
      Iota(positions.size(), static_cast<uint32_t>(complex->points.size()));
  Append(positions, &complex->points);
  complex->vertex_cells.resize(complex->points.size(), kNone);
  const Progress silent;
  InsertionProgress inserted(added.size(), silent);
  InsertSerially(added, &inserted, complex);
}

}  // namespace colmap_ext
