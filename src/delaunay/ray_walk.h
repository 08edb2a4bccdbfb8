#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"
#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A facet that a ray crosses, as the two arcs through it: 4 * cell + facet of
// the cell that the ray leaves, and of the cell that it enters.
struct Crossing {
  uint32_t exit_arc = 0;
  uint32_t entry_arc = 0;
  // From the ray's origin, scene units; infinity if not computed.
  float distance = std::numeric_limits<float>::infinity();
};

// In place of the cell where a ray ends: the ray continues to the hull, as no
// cell has this index.
inline constexpr uint32_t kToHull = kNone - 1;

struct Ray {
  uint32_t origin = 0;     // a vertex, or kNone
  Eigen::Vector3d target;  // world frame
  uint32_t end = kNone;    // the cell where it ends, or kNone
  // Distances are computed up to the first one beyond, scene units, and all of
  // them where `end` is kNone.
  double near_distance = 0;
  // Where `origin` is kNone: where the ray starts, and the cell that it
  // enters there (EnteredCell).
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  uint32_t start_cell = kNone;
};

// The way of a ray.
struct RayPath {
  std::vector<Crossing> crossings;  // in order
  // The cell where it ends, or kNone if the walk failed (the target is the
  // origin); then the crossings are invalid.
  uint32_t end = kNone;
};

// Walks rays from cell to cell through the tetrahedralization and lists the
// facets that they cross. A ray ends where it enters the cell `end` or an
// infinite one; where `end` is kNone it ends in the cell of the target. Several
// rays advance in turn, so that memory latency is hidden.
//
// All turns are exact and those of one ray in general position, so that every
// walk ends [Devillers2002], whether the ray runs through vertices, along edges
// or within facets. Whether a facet is crossed, and at which distance, depends
// on the ray and the facet alone.
//
// \param paths [rays] are overwritten
// \pre Delaunay: a walk around a vertex relies on it to end.
void WalkRays(const Tetrahedralization& tetrahedra, std::span<const Ray> rays,
              std::span<RayPath> paths);

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
