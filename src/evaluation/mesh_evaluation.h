#pragma once

#include <cstddef>
#include <functional>
#include <optional>
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
  // Every stride-th pixel of every stride-th row of the views is cast, px, 1
  // to 1000. The default is a choice.
  int stride = 3;

  // Side of the voxels of which each has one sample of a surface, scene units.
  // 0: 0.001 of the diagonal of the truth's bounding box. DTU has 0.2 mm.
  double spacing = 0;

  // Distances are clipped here, scene units. 0: 0.05 of the diagonal. DTU has
  // 20 mm.
  double max_distance = 0;

  // Leave out distances beyond instead, as DTU's own evaluation does.
  bool drop_beyond = false;

  // Depths with smaller errors are right, scene units, > 0. The defaults are
  // those of [HuMordohai2012], if the scene's unit is a metre.
  std::vector<double> depth_thresholds = {0.02, 0.1};
};

// What is known to be true: a surface, points of it (no facets), or depth maps.
struct Truth {
  TriangleMesh surface;

  // Instead of the surface, if set: the depth map of the whole image of a view,
  // by its index; without depths where there is none.
  std::function<DepthMap(size_t view)> depth_maps;

  bool IsPoints() const { return !depth_maps && surface.facets.empty(); }
};

// The protocol of the DTU data sets [Jensen2014] (docs/method.md, section 8.1).
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
  size_t num_dropped_facets = 0;  // with a vertex that is not finite
  size_t num_views = 0;           // that the comparison is restricted to; 0:
                                  // none
  size_t num_views_without_depths = 0;  // of them, without a true depth map
  std::optional<SurfaceDistances> distances;  // unless depth maps are the truth
  std::optional<DepthErrors> depths;  // if there are views, and surface or maps
};

// Compares a mesh with the truth.
//
// With views, what they see counts (docs/method.md, section 8.3): each sampled
// pixel whose ray meets the truth gives a sample of the truth and, if it meets
// the mesh, one of the mesh. If the truth is points, those in a view's image
// count, hidden or not, and every hit of the mesh. Without views, the whole
// surfaces count.
//
// \pre options in their ranges; facet indices in range; mesh and, unless depth
//      maps are the truth, surface not empty
// \throw std::invalid_argument if the truth and the views do not fit together,
//        or the spacing is too small for the scene
MeshEvaluation EvaluateMesh(const MeshEvaluationOptions& options,
                            const TriangleMesh& mesh, const Truth& truth,
                            const std::vector<View>& views,
                            const Observability& observability,
                            const Progress& progress = {});

// Returns [V] the distance of each vertex to the truth's surface or points,
// scene units, at most max_distance, which it is where the vertex is not
// finite.
// \pre truth has no depth_maps
std::vector<double> VertexErrors(const TriangleMesh& mesh, const Truth& truth,
                                 double max_distance);

}  // namespace colmap_ext
