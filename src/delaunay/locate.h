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

// Whether the point lies within the cell and on none of its facets.
// \pre the cell is finite
bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell,
                      const Eigen::Vector3d& point);

}  // namespace colmap_ext
