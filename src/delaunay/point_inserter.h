#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/growing_complex.h"

namespace colmap_ext {

// Inserts points into a Delaunay tetrahedralization: the cells whose
// circumscribing spheres hold the point make room for cells from the point to
// the facets around them [Bowyer1981; Watson1981]. The result depends neither
// on the order nor on who inserts (IsInSphere).
//
// Several inserters work at once on ranges of vertices that have none in
// common, after [Marot2019]: each one changes a cell only where at least three
// of its vertices are its own, and replaces and follows one only where all four
// are. The infinite vertex is everybody's. A cell that has three vertices of
// one range has no three of another, so that nobody reads what somebody else
// changes.
class PointInserter {
 public:
  // \param begin, end  the vertices that are its own
  PointInserter(uint32_t begin, uint32_t end, GrowingComplex* complex)
      : begin_(begin), end_(end), complex_(complex) {}

  // The cells that it may take into use, and those that it has taken out of it.
  std::vector<uint32_t>& free_cells() { return free_cells_; }

  // A visibility walk to the cell that holds a point: one of them where it lies
  // on a facet, an infinite one where it lies beyond the hull.
  // \param hint  a finite cell, all of whose vertices are its own
  // \return kNoCell where the walk comes to a vertex that is not its own
  uint32_t Locate(uint32_t point, uint32_t hint) const;

  // \param cell  that holds the point
  // \return a new finite cell; kNoCell where the point is not inserted, as the
  //         cells are not its own or too few are free
  uint32_t Insert(uint32_t point, uint32_t cell);

  bool IsOwn(uint32_t cell) const;

 private:
  bool FindCavity(uint32_t point, uint32_t cell);
  uint32_t FillCavity(uint32_t point);
  uint32_t AddCell(uint32_t point, uint32_t arc);
  void Connect(uint32_t cell, uint32_t arc);
  uint32_t TurnThroughCavity(uint32_t arc, uint32_t exit) const;
  void LeaveCavity();

  uint32_t begin_;
  uint32_t end_;
  GrowingComplex* complex_;
  std::vector<uint32_t> free_cells_;
  std::vector<uint32_t> cavity_;     // cells in conflict, marked
  std::vector<uint32_t> boundary_;   // their arcs to cells that are not
  std::vector<uint32_t> new_cells_;  // [boundary]
};

}  // namespace colmap_ext
