#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "delaunay/thinning.h"
#include "delaunay/visibility_weights.h"
#include "mesh/surface.h"
#include "mesh/topology.h"
#include "meshing/fix_singular_vertices.h"
#include "meshing/noise_smoothing.h"
#include "meshing/ray_ends.h"
#include "repair/borders.h"
#include "repair/self_intersection_repair.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// The weight of an observation of a point.
enum class ObservationWeight {
  kTracks,    // 1 - exp(-n^2 / (2 s^2)) of a point that n images see,
              // s = visibility_sigma
  kConstant,  // alpha_vis
};

struct ManifoldMeshingOptions {
  // Which points become vertices.
  ThinningOptions thinning;

  // Drop the points of walls that are there twice (DropWeakerLayers).
  bool drop_weaker_layers = true;

  ObservationWeight alpha_kind = ObservationWeight::kTracks;

  // How many images have to see a point for a weight of 1 - exp(-1/2) where
  // alpha_kind is kTracks. A higher value decreases the influence of points
  // that few images see. Positive; COLMAP's default.
  double visibility_sigma = 3.0;

  // The weight of every observation where alpha_kind is kConstant. In (0, 1].
  double alpha_vis = 1.0;

  // Times the 25th percentile of the edge lengths is the distance sigma, the
  // expected noise of the points. A higher value makes the surface smoother.
  // Positive.
  double distance_sigma_factor = 1.0;

  // How far behind a point its ray expects matter, in distance sigmas.
  // Positive. [Vu2012] has 3; but the sigma here is an edge length, and three
  // of them reach through thin parts and out of them again.
  double behind_sigma = 1.0;

  // The weight of the surface quality term (AddQualityWeights) relative to one
  // observation. A higher value makes the surface smoother. In [0, 10000].
  double quality_regularization = 1.0;

  // Relabel and split cells around singular vertices before the surface is
  // extracted. Otherwise all these vertices are split.
  bool preemptive_fixing = true;

  FixingRule fixing_rule = FixingRule::kEnergy;

  // A facet is dropped where its longest side is longer than this factor times
  // the given percentile of all facets' sides. A factor of zero keeps every
  // facet. The percentile is in [0, 100]; COLMAP's default. COLMAP's factor is
  // 25, which keeps tents between roofs.
  double max_side_length_factor = 20.0;
  double max_side_length_percentile = 95.0;

  // Connected components of fewer facets are dropped. 0 or more.
  int min_component_faces = 0;

  // The surface is smoothed by the noise of its points: the strength of
  // SmoothByNoise(). Zero leaves the points where they are. In [0, 10].
  double smoothing = 1.0;

  // Only the inside is meshed: points outside are ignored, but rays to them
  // vote, and the surface is clipped at the border. nullopt: all is meshed.
  std::optional<Region> region;

  // Trimming of unsupported surface, and closing of holes.
  BorderOptions borders;

  // Remesh the surface finally, so that its facets are well-shaped.
  bool remeshing = false;
};

// What was done, for the user and the tests.
struct ManifoldMeshingReport {
  size_t num_points = 0;            // that came in
  size_t num_outside_points = 0;    // of them outside of the region
  size_t num_weaker_points = 0;     // dropped, of walls that are there twice
  size_t num_ray_ends = 0;          // of rays that meet no surface
  size_t num_depth_rays = 0;        // to depth maps, through free space
  size_t num_observations = 0;      // of them by the views
  size_t num_duplicate_points = 0;  // at the very position of another
  size_t num_vertices = 0;          // of the tetrahedralization
  size_t num_cells = 0;             // finite and infinite
  double distance_sigma = 0;        // scene units

  RayReport rays;

  int64_t flow = 0;  // of the maximum flow, in units of 1 / kWeightUnit
  int64_t cut = 0;   // the minimum cut's value, summed over its arcs
  size_t num_free_cells = 0;

  FixingReport fixing;  // [Romanoni2020, table II] has these counts

  size_t num_split_vertices = 0;  // copies made by the fan split
  size_t num_midpoints = 0;       // put into edges that the split leaves shared
  size_t num_long_facets = 0;     // dropped
  size_t num_small_components = 0;  // dropped
  SmoothingReport smoothing;
  SelfIntersectionRepair self_intersections;
  BorderReport borders;

  MeshReport mesh;  // the gate's
};

struct ManifoldMesh : Surface {
  std::vector<float> facet_confidences;  // [F] see FacetConfidences()
  ManifoldMeshingReport report;
};

// [P], the weight of each observation of a point.
std::vector<float> ObservationWeights(const ManifoldMeshingOptions& options,
                                      const PointCloud& cloud);

// The 2-manifold surface between what the views see through and what they do
// not: Delaunay tetrahedralization, visibility votes, minimum cut, fixing of
// singular vertices, surface, filters, smoothing, confidences, borders
// [Romanoni2020, section IV; Labatut2009], repair of self-intersections, which
// copies of a vertex at one position make. The result does not depend on the
// number of threads.
//
// \param ends  of more rays that meet no surface
// \param depth_ends  of rays through free space to depth maps, each with its
//        view; they do not become vertices
// \pre all positions are finite, view indices < views.size(), options in their
//      ranges.
// \throw std::invalid_argument where the points do not span a volume, or no
//        view sees any, or the region, the ends or the trimming leave nothing.
// \throw std::logic_error where the cut is not minimal or the result is not
//        manifold, which would be a bug of ours.
ManifoldMesh MeshManifold(const ManifoldMeshingOptions& options,
                          PointCloud cloud, const std::vector<View>& views,
                          const Progress& progress = {},
                          const RayEnds& ends = {}, PointCloud depth_ends = {});

}  // namespace colmap_ext
