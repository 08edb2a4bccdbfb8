#include "delaunay/growing_complex.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
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

// Cells that an inserter has at hand: more than most insertions need.
constexpr size_t kSpareCells = 1024;

// Points that are worth several threads, and a task. Choices.
constexpr size_t kMinPoints = 1024;
constexpr size_t kTaskPoints = 128;

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

void MoveCells(size_t num_cells, std::vector<uint32_t>* from,
               std::vector<uint32_t>* to) {
  const size_t kept = from->size() - std::min(num_cells, from->size());
  to->insert(to->end(), from->begin() + static_cast<ptrdiff_t>(kept),
             from->end());
  from->resize(kept);
}

// An inserter of a thread, and what it could not insert.
struct Worker {
  PointInserter inserter;
  size_t num_inserted = 0;
  std::vector<uint32_t> left_over;
};

// \param points       ascending
// \param task_points  that a thread takes at once
// \param num_spare    cells that each thread has at hand
// \return points that were not inserted, because threads were in each other's
//         way, or had too few cells; ascending
std::vector<uint32_t> TryToInsert(PointIndices points, size_t task_points,
                                  size_t num_spare, InsertionProgress* progress,
                                  GrowingComplex* complex) {
  std::vector<uint32_t>& free_cells = complex->free_cells;
  const size_t num_cells = kCellsPerPoint * points.size() +
                           num_spare * tbb::this_task_arena::max_concurrency();
  if (free_cells.size() < num_cells) {
    AddFreeCells(num_cells - free_cells.size(), complex);
  }
  std::mutex mutex;  // of free_cells
  std::atomic<uint32_t> num_workers = 0;
  tbb::enumerable_thread_specific<Worker> workers([&] {
    return Worker{PointInserter(num_workers++, complex), 0, {}};
  });
  const tbb::blocked_range<size_t> all(0, points.size(), task_points);
  tbb::parallel_for(all, [&](const tbb::blocked_range<size_t>& range) {
    Worker& worker = workers.local();
    for (size_t i = range.begin(); i < range.end(); ++i) {
      if (worker.inserter.free_cells().size() < num_spare) {
        const std::lock_guard lock(mutex);
        MoveCells(num_spare, &free_cells, &worker.inserter.free_cells());
      }
      if (worker.inserter.Insert(points[i])) {
        progress->Count(++worker.num_inserted);
      } else {
        worker.left_over.push_back(points[i]);
      }
    }
  });
  std::vector<uint32_t> left_over;
  for (Worker& worker : workers) {
    Append(worker.inserter.free_cells(), &free_cells);
    Append(worker.left_over, &left_over);
  }
  std::ranges::sort(left_over);
  return left_over;
}

// \param points  ascending
void InsertRound(PointIndices points, InsertionProgress* progress,
                 GrowingComplex* complex) {
  std::vector<uint32_t> left_over(points.begin(), points.end());
  size_t task_points = kTaskPoints;
  for (size_t spare = kSpareCells; !left_over.empty(); spare *= 2) {
    const size_t size = left_over.size();
    if (size < kMinPoints) {
      task_points = size;  // One thread, in nobody's way.
    }
    left_over = TryToInsert(left_over, task_points, spare, progress, complex);
    if (left_over.size() > size / 2) {
      task_points = size;
    }
  }
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
  InsertRound(added, &inserted, complex);
}

}  // namespace colmap_ext
