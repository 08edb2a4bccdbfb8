#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The cell that holds a point: one of them where it lies on a facet, an
// infinite one where it lies beyond the hull.
// \param point world frame
// \param hint  a finite cell near the point
// \pre Delaunay
uint32_t Locate(const Tetrahedralization& tetrahedra,
                const Eigen::Vector3d& point, uint32_t hint);

// Which of the cells that hold a ray's origin the ray enters, an infinite one
// where it leaves the hull there. Ties are broken as in RaySideExact(), so that
// a cell that other tetrahedralizations have, too, is entered in all of them or
// in none. Where the target is the origin: the cell that holds the target as it
// is moved there.
// \param cell  holds the origin, or is an infinite one that it lies beyond the
//        hull of, which is returned as it is
// \pre Delaunay
uint32_t EnteredCell(const Tetrahedralization& tetrahedra, uint32_t cell,
                     const Eigen::Vector3d& origin,
                     const Eigen::Vector3d& target);

// Whether the point lies within the cell and on none of its facets.
// \pre the cell is finite
bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell,
                      const Eigen::Vector3d& point);

}  // namespace colmap_ext
