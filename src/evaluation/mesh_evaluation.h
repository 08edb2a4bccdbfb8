#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "evaluation/depth_errors.h"
#include "evaluation/depth_samples.h"
#include "evaluation/distance_statistics.h"
#include "evaluation/observability.h"
#include "mesh/topology.h"
#include "mesh/triangle_mesh.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

struct MeshEvaluationOptions {
  // Every stride-th pixel of every stride-th row of the views is cast, px.
  int stride = 3;

  // Samples of a surface are one for each cube of this side, and distances are
  // clipped at this, scene units. 0: 0.001 and 0.05 times the diagonal of the
  // truth's bounding box. DTU has 0.2 mm and 20 mm.
  double spacing = 0;
  double max_distance = 0;

  // Leave distances beyond out instead, as DTU's own evaluation does.
  bool drop_beyond = false;

  // Depths count as right below these errors, scene units.
  std::vector<double> depth_thresholds = {0.02, 0.1};

  // What is wrong with the options, in one line; empty when all is well.
  std::string Check() const;
};

// What is known to be true: a surface, points of it where there are no facets,
// or depth maps.
struct Truth {
  TriangleMesh surface;

  // Instead of the surface, if set: the depth map of the whole image of a view,
  // by its index; without depths where there is none.
  std::function<DepthMap(size_t view)> depth_maps;

  bool IsPoints() const { return !depth_maps && surface.facets.empty(); }
};

// The protocol of the DTU data sets (Jensen et al., "Large Scale Multi-view
// Stereopsis Evaluation", 2014).
struct SurfaceDistances {
  DistanceStatistics accuracy;      // from the mesh to the truth
  DistanceStatistics completeness;  // from the truth to the mesh
  double max_distance = 0;          // scene units
  double spacing = 0;               // scene units

  // Mean of the two means and the two medians.
  double AverageScore() const;
};

struct MeshEvaluation {
  MeshReport topology;
  size_t num_dropped_facets = 0;  // of vertices that are not finite
  size_t num_views = 0;           // that the comparison is restricted to; 0: it
                                  // is not
  size_t num_views_without_depths = 0;  // of them, without a true depth map
  std::optional<SurfaceDistances> distances;  // unless depth maps are the truth
  std::optional<DepthErrors> depths;  // if there are views, and surface or maps
};

// Compares a mesh with the truth.
//
// With views, what they see counts: each sampled pixel whose ray meets the
// truth gives a sample of the truth and, if it meets the mesh, one of the mesh.
// Points have no surface to meet: of them those count that lie in a view's
// image, hidden or not, and of the mesh what any ray meets. Without views, the
// whole surfaces count.
//
// \pre options checked; facet indices in range; mesh and, unless depth maps are
//      the truth, surface not empty
// \throw std::invalid_argument if the truth and the views do not fit together.
MeshEvaluation EvaluateMesh(const MeshEvaluationOptions& options,
                            const TriangleMesh& mesh, const Truth& truth,
                            const std::vector<View>& views,
                            const Observability& observability,
                            const Progress& progress = {});

// Distance of each vertex to the truth's surface or points, scene units, at
// most max_distance; that where the vertex is not finite.
// \pre truth has no depth_maps
std::vector<double> VertexErrors(const TriangleMesh& mesh, const Truth& truth,
                                 double max_distance);

}  // namespace colmap_ext
