#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/vertex_rings.h"

namespace colmap_ext {

// The smoothness of a surface,
//
//   E = 1/2 sum over the vertices V inside the surface of
//       a_V (1 + n_V) (4 p_V (N_V . u_V - r_V) / h_V^2)^2,
//
// a the weight, u the umbrella operator, each neighbor weighted by the inverse
// of its distance (Fujiwara 1995), so that uneven meshes do not count as
// curved; N the normal, h^2 the edges' mean length over their mean inverse
// length, p the footprint of a pixel on the surface, n the number of pixels
// that V accounts for. It is the curvature in 1 / px, squared and summed over
// the pixels: whatever the mesh's resolution and the scene's scale, it stands
// in the same proportion to the photometric energy. r is what N . u is to be: 0
// for a smooth surface, or see refine/relief.h.
struct ThinPlate {
  std::vector<double> residuals;     // [V] N . u - r, scene units
  std::vector<double> coefficients;  // [V] of their squares / 2; 0 at borders
  std::vector<float> shares;         // [neighbors] of each in its vertex's u

  double Energy() const;
};

// \param weights, footprints, num_pixels, rest  [V] a, p, n and r
ThinPlate MakeThinPlate(const std::vector<double>& weights,
                        const std::vector<Eigen::Vector3f>& vertices,
                        const std::vector<Eigen::Vector3f>& normals,
                        const VertexRings& rings,
                        const std::vector<float>& footprints,
                        const std::vector<float>& num_pixels,
                        const std::vector<double>& rest);

}  // namespace colmap_ext
