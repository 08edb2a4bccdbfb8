#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "delaunay/growing_complex.h"

namespace colmap_ext {

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

}  // namespace colmap_ext
