#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/cell_part.h"
#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The line of a ray from its point to a camera's centre.
struct RayLine {
  Eigen::Vector3d origin;  // the point, world frame
  Eigen::Vector3d target;  // the centre, world frame
  // Of the origin, scene units: nothing is to be found within it.
  double near_distance;
  // As far behind the origin.
  double behind_distance;
};

// Finds the facets through which a ray enters a part beyond the near distance,
// as the walk from its origin would cross them: Ray::start_arc.
//
// \param arcs  in any order, are overwritten
// \return whether none may cross the border nearer than that, in front or
//         behind; otherwise the ray has to be walked from its origin
bool FindEntries(const Tetrahedralization& tetrahedra, const CellPart& part,
                 const RayLine& line, std::vector<uint32_t>* arcs);

}  // namespace colmap_ext
