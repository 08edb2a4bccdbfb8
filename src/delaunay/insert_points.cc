#include "delaunay/growing_complex.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>
#include <utility>

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

// Points that several threads share, and of a task, at least. Choices.
constexpr size_t kMinSharedPoints = 1024;
constexpr size_t kTaskPoints = 128;

using PointIndices = std::span<const uint32_t>;

// Reports how many of all points are inserted.
struct InsertionProgress {
  size_t num_points;
  const Progress& progress;
  size_t num_done = 0;

  void Add(size_t num_inserted) {
    num_done += num_inserted;
    Report(progress, kTriangulatingStage,
           static_cast<double>(num_done) / static_cast<double>(num_points));
  }
};

void MoveCells(size_t num_cells, std::vector<uint32_t>* from,
               std::vector<uint32_t>* to) {
  const size_t kept = from->size() - std::min(num_cells, from->size());
  to->insert(to->end(), from->begin() + static_cast<ptrdiff_t>(kept),
             from->end());
  from->resize(kept);
}

// A thread with its inserter.
struct Worker {
  PointInserter inserter;
  size_t num_inserted = 0;          // since the last report
  std::vector<uint32_t> left_over;  // points that it could not insert
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
  AddFreeCells(num_cells - std::min(num_cells, free_cells.size()), complex);
  std::mutex mutex;  // of free_cells, and the progress
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
        progress->Add(std::exchange(worker.num_inserted, 0));
      }
      if (worker.inserter.Insert(points[i])) {
        ++worker.num_inserted;
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
    if (size < kMinSharedPoints) {
      task_points = size;  // One thread, in nobody's way.
    }
    left_over = TryToInsert(left_over, task_points, spare, progress, complex);
    if (left_over.size() > size / 2) {
      task_points = size;
    }
  }
}

}  // namespace

bool PointInserter::TryLock(uint32_t cell) const {
  uint16_t expected = GrowingComplex::kUnlocked;
  return LockOf(cell).compare_exchange_strong(expected, is_beside_,
                                              std::memory_order_acquire,
                                              std::memory_order_relaxed);
}

void PointInserter::Unlock(uint32_t cell) const {
  LockOf(cell).store(GrowingComplex::kUnlocked, std::memory_order_release);
}

// \return the last vertex before the point, or else the first one after it:
//         points with close numbers are close to each other
uint32_t PointInserter::FindStart(uint32_t point) const {
  uint32_t vertex = point;
  while (vertex > 0 && CellOf(vertex) == kNone) {
    --vertex;
  }
  while (CellOf(vertex) == kNone) {
    ++vertex;
  }
  return vertex;
}

// A visibility walk to the cell that contains a point: one of them if it lies
// on a facet, an infinite one if it lies beyond the hull. Each cell is locked
// before the last one is left.
// \return the cell, locked; kNone if another inserter holds one on the way
uint32_t PointInserter::Locate(uint32_t point) {
  uint32_t at = CellOf(FindStart(point));
  if (!TryLock(at)) {
    return kNone;
  }
  if (InfiniteCorner(complex_->cells[at]) != 4) {
    Unlock(at);  // Others have put the vertex into other cells.
    return kNone;
  }
  uint32_t entry = 4;
  for (;;) {
    const GrowingComplex::Cell& cell = complex_->cells[at];
    uint32_t exit = 0;
    while (exit < 4 &&
           (exit == entry || OrientationWith(*complex_, cell, exit,
                                             complex_->points[point]) >= 0)) {
      ++exit;
    }
    if (exit == 4) {
      return at;
    }
    const uint32_t mirror = cell.mirror_facets[exit];
    const bool is_locked = TryLock(mirror / 4);
    Unlock(at);
    if (!is_locked) {
      return kNone;
    }
    at = mirror / 4;
    entry = mirror % 4;
    if (complex_->cells[at].vertices[entry] == kInfiniteVertex) {
      return at;
    }
  }
}

bool PointInserter::Insert(uint32_t point) {
  if (CellOf(point) != kNone) {
    return true;
  }
  const uint32_t cell = Locate(point);
  if (cell == kNone) {
    return false;
  }
  const bool is_inserted = FindCavity(point, cell) && FillCavity(point);
  for (const uint32_t changed : is_inserted ? new_cells_ : cavity_) {
    Unlock(changed);
  }
  for (const uint32_t beside : beside_) {
    Unlock(beside);
  }
  return is_inserted;
}

// Locks the cells of the cavity and beside it.
// \param cell  contains the point, locked
// \return whether no other inserter holds any of them
bool PointInserter::FindCavity(uint32_t point, uint32_t cell) {
  boundary_.clear();
  beside_.clear();
  cavity_.clear();
  const auto add = [&](uint32_t locked) {
    LockOf(locked).store(is_in_cavity_, std::memory_order_relaxed);
    cavity_.push_back(locked);
  };
  add(cell);
  for (size_t k = 0; k < cavity_.size(); ++k) {
    for (uint32_t i = 0; i < 4; ++i) {
      const uint32_t other = complex_->cells[cavity_[k]].mirror_facets[i] / 4;
      const uint16_t lock = LockOf(other).load(std::memory_order_relaxed);
      if (lock == is_in_cavity_) {
        continue;
      }
      if (lock != is_beside_) {
        if (!TryLock(other)) {
          return false;
        }
        if (IsInConflict(*complex_, other, complex_->points[point])) {
          add(other);
          continue;
        }
        beside_.push_back(other);
      }
      boundary_.push_back(4 * cavity_[k] + i);
    }
  }
  return true;
}

// \return whether enough cells are free
bool PointInserter::FillCavity(uint32_t point) {
  if (free_cells_.size() < boundary_.size()) {
    return false;
  }
  new_cells_.clear();
  for (const uint32_t arc : boundary_) {
    new_cells_.push_back(AddCell(point, arc));
  }
  for (size_t i = 0; i < boundary_.size(); ++i) {
    Connect(new_cells_[i], boundary_[i]);
  }
  for (const uint32_t cell : cavity_) {
    LockOf(cell).store(GrowingComplex::kNotInUse, std::memory_order_relaxed);
  }
  Append(cavity_, &free_cells_);
  return true;
}

// Makes the cell from the point to a facet of the cavity's boundary: the cell
// inside, with the corner opposite to the facet replaced by the point.
uint32_t PointInserter::AddCell(uint32_t point, uint32_t arc) {
  const uint32_t index = free_cells_.back();
  free_cells_.pop_back();
  std::vector<GrowingComplex::Cell>& cells = complex_->cells;
  GrowingComplex::Cell& cell = cells[index];
  cell.vertices = cells[arc / 4].vertices;
  cell.vertices[arc % 4] = point;
  cell.mirror_facets.fill(kNone);
  const uint32_t outside = cells[arc / 4].mirror_facets[arc % 4];
  cell.mirror_facets[arc % 4] = outside;
  cells[outside / 4].mirror_facets[outside % 4] = 4 * index + arc % 4;
  if (InfiniteCorner(cell) == 4) {
    for (const uint32_t vertex : cell.vertices) {
      std::atomic_ref(complex_->vertex_cells[vertex])
          .store(index, std::memory_order_relaxed);
    }
  }
  return index;
}

// Connects a new cell with the new ones beside it.
// \param arc  the facet of the cavity's boundary that the cell was made from
void PointInserter::Connect(uint32_t cell, uint32_t arc) {
  std::vector<GrowingComplex::Cell>& cells = complex_->cells;
  for (uint32_t i = 0; i < 4; ++i) {
    if (cells[cell].mirror_facets[i] == kNone) {
      const uint32_t mirror = TurnThroughCavity(arc, i);
      cells[cell].mirror_facets[i] = mirror;
      cells[mirror / 4].mirror_facets[mirror % 4] = 4 * cell + i;
    }
  }
}

// Turns through the cavity around an edge of a facet of its boundary, up to the
// next facet of the boundary.
// \param arc   the facet
// \param exit  the corner of the facet that is not on the edge
// \return the facet that the new cell there has with the one at the start
uint32_t PointInserter::TurnThroughCavity(uint32_t arc, uint32_t exit) const {
  const std::vector<GrowingComplex::Cell>& cells = complex_->cells;
  uint32_t at = arc / 4;
  uint32_t entry = arc % 4;
  for (;;) {
    const uint32_t mirror = cells[at].mirror_facets[exit];
    const uint32_t next = mirror / 4;
    if (LockOf(next).load(std::memory_order_relaxed) != is_in_cavity_) {
      // The cell outside of the cavity is already connected to the new cell.
      return cells[next].mirror_facets[mirror % 4] / 4 * 4 + entry;
    }
    const uint32_t pivot = cells[at].vertices[entry];
    at = next;
    entry = mirror % 4;
    exit = PlaceOf(pivot, cells[at].vertices);
  }
}

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
  InsertionProgress inserted{order.size(), progress};
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
  InsertionProgress inserted{added.size(), silent};
  InsertRound(added, &inserted, complex);
}

}  // namespace colmap_ext
