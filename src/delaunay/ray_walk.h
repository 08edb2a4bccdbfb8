#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A facet that a ray crosses, as the two arcs through it: 4 * cell + facet of
// the cell that the ray leaves, and of the cell that it enters.
struct Crossing {
  uint32_t exit_arc = 0;
  uint32_t entry_arc = 0;
  // From the ray's origin, scene units; infinity where nobody asked.
  float distance = std::numeric_limits<float>::infinity();
};

// Walks a ray from cell to cell through the tetrahedralization and lists the
// facets that it crosses, in order. It ends where it enters the cell `end` or
// an infinite one; where `end` is kNoCell it ends in the cell of the target.
//
// All turns are exact and those of one ray in general position, so that every
// walk ends [Devillers2002], whether the ray runs through vertices, along edges
// or within facets.
// Distances are computed up to the first one beyond `near_distance`, and all of
// them where `end` is kNoCell.
//
// \param origin  a vertex
// \param target, near_distance  world frame, scene units
// \param end     a cell, or kNoCell
// \param crossings  are overwritten
// \pre Delaunay: a walk around a vertex relies on it to end.
// \return the cell where the walk ended, or kNoCell where it had to be given up
//         (the target is the origin); then *crossings means nothing.
uint32_t WalkRay(const Tetrahedralization& tetrahedra, uint32_t origin,
                 const Eigen::Vector3d& target, uint32_t end,
                 double near_distance, std::vector<Crossing>* crossings);

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
