#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A surface, and how large pixels are on it. All [V].
struct PlateSurface {
  const std::vector<Eigen::Vector3f>& vertices;  // scene units
  const std::vector<Eigen::Vector3f>& normals;   // unit
  const VertexRings& rings;
  const std::vector<float>& footprints;  // p, of a pixel, scene units; 0: none
  const std::vector<float>& num_pixels;  // n, that a vertex accounts for
};

// The smoothness of a surface (docs/method.md, section 6.2),
//
//   E = 1/2 sum over the vertices V of
//       a_V (1 + n_V) (4 p_V (N_V . u_V - r_V) / h_V^2)^2.
//
// a is the weight, N the normal, and u the umbrella operator: each neighbor
// counts by the inverse of its distance [Fujiwara1995], so that uneven meshes
// do not count as curved. h^2 is the edges' mean length over their mean inverse
// length. r is the relief, what N . u is to be; 0 for a smooth surface.
//
// For r = 0 this is the sum of the principal curvatures in 1 / px, squared and
// summed over the pixels: it stands in the same proportion to the photometric
// energy whatever the mesh's resolution and the scene's scale. At a border u is
// one-sided; along the normal that is curvature still.
struct ThinPlate {
  std::vector<double> residuals;     // [V] N . u - r, scene units
  std::vector<double> coefficients;  // [V] of their squares / 2; 0 where a
                                     // vertex has no neighbors or footprint
  std::vector<float>
      shares;  // [neighbors of `rings`] of each in its vertex's u

  double Energy() const;
};

// \param weights  [V] a, positive
// \param relief  [V] r, scene units
ThinPlate MakeThinPlate(const PlateSurface& surface,
                        const std::vector<double>& weights,
                        const std::vector<double>& relief);

// The relief of a surface, N . u at each vertex: the umbrella operator u along
// the normal (refine/thin_plate.h). [V] scene units.
// \param footprints  [V] of a pixel, scene units.
std::vector<double> Relief(const TriangleMesh& mesh, const VertexRings& rings,
                           const std::vector<float>& footprints);

// The part of the relief that is trusted before any image is seen. It is
// averaged over a ring, as differences between neighbors are noise of the
// points; and it is 0 at borders, and where the surface is curved as spikes
// are. [V] scene units
std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints);

// The share of a given relief that a surface has, from 0 to 1: [V] the factor
// of the relief that comes closest to the surface's own in the surroundings of
// each vertex (AverageOverSurroundings); 0 where these have little relief
// (docs/method.md, section 6.6).
//
// A surface that was refined without regard to the relief has that of an
// accurate mesh, since both show what is there, and little of the noise of an
// inaccurate one.
//
// \param importance  [V] of the squared differences; 0 leaves a vertex out.
// \param relief, surface  [V] N . u of both, scene units.
std::vector<double> ReliefShares(const VertexRings& rings,
                                 const std::vector<double>& importance,
                                 const std::vector<double>& relief,
                                 const std::vector<double>& surface);

}  // namespace colmap_ext
