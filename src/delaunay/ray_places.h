#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A place and the cell that has it strictly inside, or an infinite one.
struct RayPlace {
  Eigen::Vector3d position;
  uint32_t cell = kNoCell;
};

// A place on a facet lies strictly inside no cell, and a walk may end in
// another one than it does, as it treats the place as moved by an
// infinitesimal step. Such a place is moved, by a millionth of the points'
// noise at each try and in a direction that no simple plane contains.
// \param sigma  the points' noise, scene units
// \param hint   a finite cell near the place
RayPlace FindPlace(const Tetrahedralization& tetrahedra,
                   const Eigen::Vector3d& position, double sigma,
                   uint32_t hint);

// The cameras' centres. That of one beyond the hull has no cell's index, but
// their number.
std::vector<RayPlace> LocateCenters(const Tetrahedralization& tetrahedra,
                                    const std::vector<Eigen::Vector3d>& centers,
                                    double sigma);

}  // namespace colmap_ext
