#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A Delaunay tetrahedralization while points are inserted. A point is a vertex
// once it is inserted. Cells are oriented as those of a Tetrahedralization, and
// infinite ones close the hull.
struct GrowingComplex {
  struct alignas(32) Cell {
    std::array<uint32_t, 4> vertices;  // index into points, or kInfiniteVertex
    // [i]: the mirror facet of the facet opposite to vertex i: the same facet
    // in the neighboring cell, as 4 * cell + facet.
    std::array<uint32_t, 4> mirror_facets;
  };

  std::vector<Eigen::Vector3f> points;  // [P], distinct
  std::vector<Cell> cells;              // [C], those not in use included
  std::vector<uint8_t> is_marked;       // [C], scratch of an insertion
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
// \param numbers [P] from 0 on, each once, of the points that are inserted;
//        kNone: of the others
Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex);

}  // namespace colmap_ext
