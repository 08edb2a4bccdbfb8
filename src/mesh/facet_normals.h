#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns [F] unit normals, to the side from which the corners run
// counter-clockwise; zero where a facet has no area.
// \pre facet indices are in range
std::vector<Eigen::Vector3f> FacetNormals(const TriangleMesh& mesh);

// Returns one of them.
// \pre facet < F, its indices are in range
Eigen::Vector3f FacetNormal(const TriangleMesh& mesh, size_t facet);

// Returns a facet's normal, as long as its angle at a corner, radians; zero
// where the facet has no area.
// \param corner  0, 1 or 2
// \pre the facet's indices are in range
Eigen::Vector3d AngleVector(const TriangleMesh& mesh, const Facet& facet,
                            uint32_t corner);

// Counts the facets whose normals turn by more than a right angle from one set
// of positions to another. Facets without area do not count.
// \param before, after  [V] scene units
// \pre facet indices < V
size_t CountFlippedFacets(const std::vector<Facet>& facets,
                          const std::vector<Eigen::Vector3f>& before,
                          const std::vector<Eigen::Vector3f>& after);

}  // namespace colmap_ext
