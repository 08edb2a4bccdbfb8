#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "delaunay/inherit_attributes.h"
#include "delaunay/manifold_fixing.h"
#include "delaunay/visibility_weights.h"
#include "mesh/facet_filters.h"
#include "mesh/topology.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

struct ManifoldMeshingOptions {
  // Unify input points into one cell in the Delaunay triangulation that fall
  // within a reprojected radius of the given pixels. Zero keeps every point.
  double max_proj_dist = 20.0;

  // Maximum relative depth difference between input point and a vertex of an
  // existing cell in the Delaunay triangulation, otherwise a new vertex is
  // created in the triangulation. In [0, 1].
  double max_depth_dist = 0.05;

  // The weight of an observation: "tracks" for 1 - exp(-n^2 / (2 s^2)) of a
  // point seen by n images, s = visibility_sigma; "constant" for alpha_vis.
  std::string alpha_kind = "tracks";

  // The standard deviation wrt. the number of images seen by each point.
  // Increasing this value decreases the influence of points seen in few images.
  double visibility_sigma = 3.0;

  // The weight of every observation where alpha_kind is "constant". In (0, 1].
  double alpha_vis = 1.0;

  // The factor that is applied to the computed distance sigma, which is
  // automatically computed as the 25th percentile of edge lengths. A higher
  // value will increase the smoothness of the surface.
  double distance_sigma_factor = 1.0;

  // How far behind a point its ray looks for matter, in distance sigmas. Vu et
  // al. have 3; but the sigma here is an edge length, and three of them reach
  // through thin parts and out of them again.
  double behind_sigma = 1.0;

  // A higher quality regularization leads to a smoother surface.
  double quality_regularization = 1.0;

  // Relabel and split cells around singular vertices before the surface is
  // extracted. Without it all of them are split.
  bool preemptive_fixing = true;

  // How: "paper" for its three passes, "energy" for our variant of them.
  std::string fixing_rule = "energy";

  // Filtering thresholds for outlier surface mesh faces. If the longest side of
  // a mesh face (longest out of 3) exceeds the side lengths of all faces at a
  // certain percentile by the given factor, then it is considered an outlier
  // mesh face and discarded. A factor of zero keeps every face.
  double max_side_length_factor = 25.0;
  double max_side_length_percentile = 95.0;

  // Connected components of fewer faces are discarded.
  int min_component_faces = 0;

  // The number of threads to use. Default is all threads. The result does not
  // depend on it.
  int num_threads = -1;

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// What was done, for the user and the tests.
struct ManifoldMeshingReport {
  size_t num_points = 0;            // that came in
  size_t num_observations = 0;      // of them by the views
  size_t num_duplicate_points = 0;  // at the very position of another
  size_t num_vertices = 0;          // of the tetrahedralization
  size_t num_cells = 0;             // finite and infinite
  double distance_sigma = 0;        // scene units

  RayReport rays;

  int64_t flow = 0;  // of the maximum flow, in units of 1 / kWeightUnit
  int64_t cut = 0;   // the minimum cut's value, summed over its arcs
  size_t num_free_cells = 0;

  FixingReport fixing;  // Table II: singular vertices raw, after fixing

  size_t num_split_vertices = 0;  // copies made by the fan split
  size_t num_midpoints = 0;       // put into edges that the split leaves shared
  size_t num_long_facets = 0;     // dropped
  DroppedComponents small_components;

  MeshReport mesh;  // the gate's
};

struct ManifoldMesh {
  TriangleMesh mesh;
  VertexAttributes attributes;
  ManifoldMeshingReport report;
};

// The 2-manifold surface between what the views see through and what they do
// not: Delaunay tetrahedralization, visibility votes, minimum cut, fixing of
// singular vertices, surface, filters (Romanoni and Matteucci, section III;
// Labatut et al. 2009).
//
// \pre all positions are finite, view indices < views.size(), options checked.
// \throw std::invalid_argument where the points do not span a volume, or no
//        view sees any.
// \throw std::logic_error where the result is not manifold, which would be a
//        bug of ours.
ManifoldMesh MeshManifold(const ManifoldMeshingOptions& options,
                          const PointCloud& cloud,
                          const std::vector<View>& views,
                          const Progress& progress = {});

}  // namespace colmap_ext
