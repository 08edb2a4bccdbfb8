#include "delaunay/growing_complex.h"

#include <algorithm>

#include "base/index_limit.h"

namespace colmap_ext {

bool PointInserter::IsOwn(uint32_t cell) const {
  return std::ranges::all_of(
      complex_->cells[cell].vertices, [&](uint32_t vertex) {
        return vertex - begin_ < end_ - begin_ || vertex == kInfiniteVertex;
      });
}

uint32_t PointInserter::FindOwnCell() const {
  for (uint32_t vertex = begin_; vertex < end_; ++vertex) {
    const uint32_t cell = complex_->vertex_cells[vertex];
    if (cell != kNone && IsOwn(cell)) {
      return cell;
    }
  }
  return kNone;
}

uint32_t PointInserter::Locate(uint32_t point, uint32_t hint) const {
  uint32_t at = hint;
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
    at = cell.mirror_facets[exit] / 4;
    entry = cell.mirror_facets[exit] % 4;
    if (!IsOwn(at)) {
      return kNone;
    }
    if (complex_->cells[at].vertices[entry] == kInfiniteVertex) {
      return at;
    }
  }
}

uint32_t PointInserter::Insert(uint32_t point, uint32_t cell) {
  const bool is_found = FindCavity(point, cell);
  const uint32_t result = is_found ? FillCavity(point) : kNone;
  for (const uint32_t marked : cavity_) {
    complex_->is_marked[marked] = 0;
  }
  return result;
}

// \return whether the inserter owns all cells of the cavity
bool PointInserter::FindCavity(uint32_t point, uint32_t cell) {
  boundary_.clear();
  cavity_.assign(1, cell);
  complex_->is_marked[cell] = 1;
  for (size_t k = 0; k < cavity_.size(); ++k) {
    for (uint32_t i = 0; i < 4; ++i) {
      const uint32_t other = complex_->cells[cavity_[k]].mirror_facets[i] / 4;
      if (complex_->is_marked[other]) {
        continue;
      }
      if (!IsInConflict(*complex_, other, complex_->points[point])) {
        boundary_.push_back(4 * cavity_[k] + i);
      } else if (IsOwn(other)) {
        complex_->is_marked[other] = 1;
        cavity_.push_back(other);
      } else {
        return false;
      }
    }
  }
  return true;
}

// \return a new finite cell, or kNone where too few are free
uint32_t PointInserter::FillCavity(uint32_t point) {
  if (free_cells_.size() < boundary_.size()) {
    return kNone;
  }
  new_cells_.clear();
  for (const uint32_t arc : boundary_) {
    new_cells_.push_back(AddCell(point, arc));
  }
  uint32_t finite = kNone;
  for (size_t i = 0; i < boundary_.size(); ++i) {
    Connect(new_cells_[i], boundary_[i]);
    if (InfiniteCorner(complex_->cells[new_cells_[i]]) == 4) {
      finite = new_cells_[i];
    }
  }
  free_cells_.insert(free_cells_.end(), cavity_.begin(), cavity_.end());
  return finite;
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
      complex_->vertex_cells[vertex] = index;
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
    if (!complex_->is_marked[next]) {
      // The cell outside of the cavity is already connected to the new cell.
      return cells[next].mirror_facets[mirror % 4] / 4 * 4 + entry;
    }
    const uint32_t pivot = cells[at].vertices[entry];
    at = next;
    entry = mirror % 4;
    exit = PlaceOf(pivot, cells[at].vertices);
  }
}

}  // namespace colmap_ext
