#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The noise of measured points at some places: the root mean square distance of
// the nearest points to the quadric that fits them, weighted towards the place.
// [places], scene units; 0 where there are too few points to tell.
// \param points  finite
std::vector<float> LocalNoise(std::span<const Eigen::Vector3f> points,
                              const std::vector<Eigen::Vector3f>& places);

// What SmoothByNoise() did.
struct SmoothingReport {
  size_t num_moved = 0;  // vertices
  size_t num_kept = 0;   // vertices put back, as their facets would intersect
};

// Moves the vertices p of a mesh to the x that minimize
//
//   sum_v |x_v - p_v|^2 / s_v^2 + sum_v |m_v(x) - x_v|^2 / (c_v e_v)^2
//
// with the noise s_v of the vertex, the mean m_v of its neighbors, and the mean
// length e_v of its edges: the most likely surface, where measurements have
// noise and the umbrella vectors m - x of a surface have a normal distribution
// with a deviation of c_v times the edges' lengths. c_v is what the surface
// itself has around the vertex, estimated in turn with x: walls get smooth, and
// edges and relief stay. What the points know exactly stays, spikes of the
// noise go. A vertex at a border has its neighbors on the border, so that
// borders keep their shape. No vertex moves farther than e_v, nor so far that a
// facet of it could pass over the centre of a camera; corners of facets that
// would intersect go back to where they were.
//
// \param centers  of the cameras, which are in free space
// \param noises [V] scene units; infinity: the position is not a measurement
// \param strength  divides the bounds of c_v; positive, higher is smoother
// \pre no edge has more than two facets
SmoothingReport SmoothByNoise(const std::vector<Eigen::Vector3f>& centers,
                              const std::vector<float>& noises, double strength,
                              TriangleMesh* mesh);

}  // namespace colmap_ext
