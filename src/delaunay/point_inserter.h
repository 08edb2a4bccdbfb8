#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/growing_complex.h"

namespace colmap_ext {

// Inserts points into a Delaunay tetrahedralization: the cells whose
// circumspheres contain the point are replaced by cells from the point to the
// facets of the cavity [Bowyer1981; Watson1981]. The result depends neither on
// the order of insertion nor on the inserter (IsInSphere).
//
// Several inserters work concurrently on disjoint ranges of vertices
// [Marot2019]. An inserter changes a cell only if it owns at least three of its
// vertices, and replaces or walks through a cell only if it owns all four. All
// inserters own the infinite vertex. No data race: of a cell, at most one
// inserter owns three vertices.
class PointInserter {
 public:
  // \param begin, end  the range of vertices that the inserter owns
  PointInserter(uint32_t begin, uint32_t end, GrowingComplex* complex)
      : begin_(begin), end_(end), complex_(complex) {}

  // Unused cells: those that the inserter may use, and those that it released.
  std::vector<uint32_t>& free_cells() { return free_cells_; }

  // A visibility walk to the cell that contains a point: one of them if it lies
  // on a facet, an infinite one if it lies beyond the hull.
  // \param hint  a finite cell, all of whose vertices the inserter owns
  // \return kNone if the walk meets a vertex that the inserter does not own
  uint32_t Locate(uint32_t point, uint32_t hint) const;

  // \param cell  contains the point
  // \return a new finite cell; kNone if the point is not inserted, because
  //         the inserter does not own the cells or too few are free
  uint32_t Insert(uint32_t point, uint32_t cell);

  bool IsOwn(uint32_t cell) const;

 private:
  bool FindCavity(uint32_t point, uint32_t cell);
  uint32_t FillCavity(uint32_t point);
  uint32_t AddCell(uint32_t point, uint32_t arc);
  void Connect(uint32_t cell, uint32_t arc);
  uint32_t TurnThroughCavity(uint32_t arc, uint32_t exit) const;

  uint32_t begin_;
  uint32_t end_;
  GrowingComplex* complex_;
  std::vector<uint32_t> free_cells_;
  std::vector<uint32_t> cavity_;     // cells in conflict, marked
  std::vector<uint32_t> boundary_;   // their arcs to cells that are not
  std::vector<uint32_t> new_cells_;  // [boundary]
};

}  // namespace colmap_ext
