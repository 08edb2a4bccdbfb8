#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Whether two facets of a mesh meet in more than what they share by index. All
// signs are exact (spatial/predicates.h).
// - Facets without a common vertex: whether they have a point in common; one
//   that touches the other does.
// - With one common vertex: whether the side opposite of it, of one, has a
//   point in common with the other.
// - With two: whether they lie in one plane, folded onto each other.
// - With three: they do.
// A facet whose corners lie on one line meets none.
//
// This is what CGAL's Polygon_mesh_processing::self_intersections() counts.
// \param vertices  [V] finite
// \pre facet indices < V, no facet repeats a vertex
bool FacetsIntersect(const std::vector<Eigen::Vector3f>& vertices,
                     const Facet& first, const Facet& second);

}  // namespace colmap_ext
