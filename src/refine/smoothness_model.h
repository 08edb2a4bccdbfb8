#pragma once

#include <cstdint>
#include <vector>

#include "labeling/view_pairs.h"
#include "mesh/adjacency.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "photometry/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

// Ten rounds of AverageOverNeighbors(). On a regular mesh that is a Gaussian of
// about two edges' standard deviation on each axis.
// \param values  [V]
void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values);

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
// the normal. [V] scene units.
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

// Evidence for the weight of the smoothness, per vertex. Both [V].
struct SmoothnessEvidence {
  // How far the images determine where the vertex is (0 to 1, but for the noise
  // of the estimate), times how often they count the same noise, times the
  // user's factor on the weight.
  std::vector<double> determined;

  // The energy of the smoothness for a weight of 2.
  std::vector<double> roughness;
};

// The weight for which the surface, where the images determine it, is as rough
// as the smoothness expects: sum determined / sum roughness [MacKay1992, the
// evidence for alpha]. Infinite where nothing is rough.
double GlobalWeight(const SmoothnessEvidence& evidence);

// The same for the surroundings of each vertex, so that a plastered wall
// becomes smooth although the cornice above it is not: [V]. Where the
// surroundings determine next to nothing, the weight is the global one. It is
// never far below that: badly matched images leave noise that looks like
// relief.
//
// \param weight  the global one; positive.
std::vector<double> LocalWeights(const VertexRings& rings,
                                 SmoothnessEvidence evidence, double weight);

// A surface that is refined, and what the images say of it.
struct EvaluatedSurface {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3f> normals;  // [V] unit, see VertexNormals()
  PhotometricTerms terms;                // of the mesh
};

// Input of the smoothness that does not depend on vertex positions. All [V].
struct SmoothnessDomain {
  VertexRings rings;
  std::vector<float> footprints;       // of a pixel, scene units
  std::vector<float> num_pixels;       // that a vertex accounts for
  std::vector<uint8_t> is_seen;        // any pixel was compared at first
  std::vector<double> trusted_relief;  // of the input's surface, scene units; 0
                                       // where it is not seen. Empty at coarse
                                       // levels.
  FixedVertices fixed;
};

// The footprint of a pixel on the surface at each vertex: [V] scene units. The
// mean over the views of the best pairs of the facets at the vertex; the median
// of all where there are none. 0 if no facet has a label.
// \param views  of the size of the level's images.
std::vector<float> VertexFootprints(const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const FacetLabels& labels,
                                    const std::vector<View>& views);

// Whether any pixel is compared on a facet at the vertex: [V].
std::vector<uint8_t> SeenVertices(const TriangleMesh& mesh,
                                  const PhotometricTerms& terms);

// The pixels that each vertex accounts for: [V] a third of those compared on
// its facets, in all directions of all pairs, or of those that the facets
// cover, if that is more. Without the area, large facets of which little is
// compared have no stiffness, and the noise of a few pixels raises them to
// spikes (docs/method.md, section 6.2).
// \param footprints  [V] see VertexFootprints()
std::vector<float> PixelsOfVertices(const TriangleMesh& mesh,
                                    const PhotometricTerms& terms,
                                    const std::vector<float>& footprints);

// Targets of the smoothness for a surface.
struct SmoothnessTarget {
  double weight = 0;            // a of the whole surface
  std::vector<double> weights;  // [V] a, see ThinPlate
  std::vector<double> relief;   // [V] r, see ThinPlate, scene units
};

// A target, and the deviation of a surface from it: plate.residuals +
// target.relief is the surface's own relief wherever there is smoothness.
struct SmoothnessModel {
  SmoothnessTarget target;
  ThinPlate plate;
};

// What the smoothness asks of a surface at the start of a level. At a coarse
// level, and where the surface is not seen, that it keeps the relief that it
// has: coarse images cannot tell fine relief from noise, and must not flatten
// it. Elsewhere that it has none.
SmoothnessTarget FirstTarget(const SmoothnessDomain& domain,
                             const TriangleMesh& mesh, double weight);

// The only maker of models.
// \pre target and domain are of the surface's vertices
SmoothnessModel MakeSmoothnessModel(SmoothnessTarget target,
                                    const SmoothnessDomain& domain,
                                    const EvaluatedSurface& surface);

// The plate of a target on another surface.
ThinPlate PlateOf(const SmoothnessTarget& target,
                  const SmoothnessDomain& domain,
                  const EvaluatedSurface& surface);

// The target whose relief is, where the surface is seen, as much of the trusted
// one as the surface has (ReliefShares()).
// \pre domain.trusted_relief is not empty
SmoothnessTarget ConfirmRelief(const SmoothnessDomain& domain,
                               const SmoothnessModel& model);

// The target whose weights make the surface's roughness, where the images
// determine it, as likely as it is: that of the whole surface first, then of
// each of its parts (docs/method.md, section 6.5).
// \param factor  on the weights.
SmoothnessTarget EstimateWeights(const SmoothnessDomain& domain,
                                 const EvaluatedSurface& surface,
                                 const SmoothnessModel& model, double factor);

}  // namespace colmap_ext
