#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "scene/progress.h"

namespace colmap_ext {

// A Delaunay tetrahedralization while points are inserted. A point is a vertex
// once it is inserted. Cells are oriented as those of a Tetrahedralization, and
// infinite ones close the hull.
struct GrowingComplex {
  struct alignas(32) Cell {
    // Writes nothing: the thread that fills a cell touches its memory first.
    Cell() {}  // NOLINT: neither default nor initialized

    std::array<uint32_t, 4> vertices;  // index into points, or kInfiniteVertex
    // [i]: the mirror facet of the facet opposite to vertex i: the same facet
    // in the neighboring cell, as 4 * cell + facet.
    std::array<uint32_t, 4> mirror_facets;
  };

  // Values of locks; any other one names the inserter that holds the cell.
  static constexpr uint16_t kUnlocked = 0;
  static constexpr uint16_t kNotInUse = UINT16_MAX;

  std::vector<Eigen::Vector3f> points;  // [P], distinct
  std::vector<Cell> cells;              // [C], those not in use included
  std::vector<uint16_t> locks;          // [C]
  std::vector<uint32_t> vertex_cells;   // [P], a finite cell of each, or kNone
  std::vector<uint32_t> free_cells;     // not in use
};

// Appends cells that are not in use.
// \throw std::invalid_argument where there are too many cells for 32-bit arcs
void AddFreeCells(size_t num_cells, GrowingComplex* complex);

// Whether not all points lie in a plane.
// \pre they differ
bool SpansVolume(const std::vector<Eigen::Vector3f>& points);

// Makes a complex of the first points in their order that span a volume.
// \param order  indices of points
// \return the four points
// \throw std::invalid_argument where the points span no volume
std::array<uint32_t, 4> StartComplex(std::span<const uint32_t> order,
                                     GrowingComplex* complex);

// The corner of a cell that is the infinite vertex; 4 where none is.
uint32_t InfiniteCorner(const GrowingComplex::Cell& cell);

// The orientation of a cell with a point in the place of corner i.
// \pre the other corners are finite
int OrientationWith(const GrowingComplex& complex,
                    const GrowingComplex::Cell& cell, uint32_t i,
                    const Eigen::Vector3f& point);

// Whether a point conflicts with a cell: whether it lies in the circumsphere of
// a finite cell, or beyond the hull facet of an infinite one. Perturbed as
// IsInSphere().
// \pre the point is at none of the cell's vertices
bool IsInConflict(const GrowingComplex& complex, uint32_t cell,
                  const Eigen::Vector3f& point);

// The tetrahedralization of a complex, with other numbers for the vertices. It
// depends on the points and their numbers alone. The complex is empty
// afterwards.
// \param numbers [P] from 0 on, each once
Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex);

// Inserts points into a Delaunay tetrahedralization: the cells whose
// circumspheres contain the point are replaced by cells from the point to the
// facets of the cavity [Bowyer1981; Watson1981]. The result depends neither on
// the order of insertion nor on the inserter (IsInSphere).
//
// Several inserters may work at once [Batista2010]. An inserter reads a cell
// only while it holds the cell's lock, and changes cells only while it holds
// those of all cells around. Where another one holds a lock, it does not wait,
// but gives the point up for now.
class PointInserter {
 public:
  // \param number  from 0 on; inserters that work at once have different ones
  PointInserter(uint32_t number, GrowingComplex* complex)
      : is_in_cavity_(static_cast<uint16_t>(2 * number + 1)),
        is_beside_(static_cast<uint16_t>(2 * number + 2)),
        complex_(complex) {}

  // Cells not in use: those that the inserter may use, and those that it
  // released.
  std::vector<uint32_t>& free_cells() { return free_cells_; }

  // \return whether the point is a vertex now; if not, another inserter holds a
  //         cell, or too few are free
  bool Insert(uint32_t point);

 private:
  uint32_t FindStart(uint32_t point) const;
  uint32_t Locate(uint32_t point);
  bool FindCavity(uint32_t point, uint32_t cell);
  bool FillCavity(uint32_t point);
  uint32_t AddCell(uint32_t point, uint32_t arc);
  void Connect(uint32_t cell, uint32_t arc);
  uint32_t TurnThroughCavity(uint32_t arc, uint32_t exit) const;

  bool TryLock(uint32_t cell) const;
  void Unlock(uint32_t cell) const;

  std::atomic_ref<uint16_t> LockOf(uint32_t cell) const {
    return std::atomic_ref(complex_->locks[cell]);
  }

  // kNone: the point is not inserted yet.
  uint32_t CellOf(uint32_t point) const {
    return std::atomic_ref(complex_->vertex_cells[point])
        .load(std::memory_order_relaxed);
  }

  uint16_t is_in_cavity_;  // locks
  uint16_t is_beside_;
  GrowingComplex* complex_;
  std::vector<uint32_t> free_cells_;
  std::vector<uint32_t> cavity_;     // cells in conflict
  std::vector<uint32_t> beside_;     // the cells around them
  std::vector<uint32_t> boundary_;   // arcs from the former to the latter
  std::vector<uint32_t> new_cells_;  // [boundary]
};

inline constexpr char kTriangulatingStage[] = "Triangulating points";

// The points without repeats, in their order along the Morton curve. Of points
// at one position the first is kept.
// \param representatives [P] is set to the point that is kept at each point's
//        position
// \return indices of points
// \pre all positions are finite
// \throw std::invalid_argument if there are more than 32 bits can number.
std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives);

// A biased randomized insertion order [Amenta2003]: random rounds of doubling
// size, each in ascending order. Seeds are fixed.
// \param num_points  along the curve
// \return [num_points] indices of points
std::vector<uint32_t> InsertionOrder(size_t num_points);

// Inserts points into an empty complex, in parallel. The result does not depend
// on the number of threads.
// \param order  InsertionOrder()
// \throw std::invalid_argument where the points span no volume or are too many
//        for 32-bit cell indices
void InsertPoints(const std::vector<uint32_t>& order, const Progress& progress,
                  GrowingComplex* complex);

// Appends points to a complex and inserts them: fast where neighbors in the
// list are neighbors in space. \pre the positions are new to the complex \throw
// std::invalid_argument as InsertPoints()
void InsertMorePoints(std::span<const Eigen::Vector3f> positions,
                      GrowingComplex* complex);

}  // namespace colmap_ext
