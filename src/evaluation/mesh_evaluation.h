#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mesh/topology.h"
#include "mesh/triangle_mesh.h"
#include "scene/images.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "scene/view.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// Returns the depths of a surface in a view, along rays through the centers of
// the sampled pixels, (col + 0.5, row + 0.5).
// \param stride  px, > 0
// \param facets  if not nullptr, is set to the facets that the rays hit,
//        [height * width]; -1: none
DepthMap RenderDepths(const Bvh& surface, const View& view, int stride,
                      std::vector<int32_t>* facets = nullptr);

// Counts of true depths that agree with a mesh: the protocol of the EPFL data
// sets [Strecha2008] by [HuMordohai2012] (docs/method.md, section 8.2).
struct DepthErrors {
  std::vector<double> thresholds;  // [T], scene units, of the absolute error
  std::vector<size_t> num_within;  // [T], strictly below the threshold
  size_t num_depths = 0;           // true depths
  size_t num_missing = 0;          // true depths where the mesh has none; they
                                   // are within no threshold

  // Returns num_within over num_depths, 0 ... 1; NaN if there are no depths.
  // \param threshold  its index, < T
  double Share(size_t threshold) const;
};

// Adds the pixels of a view. Values that are not finite and positive are
// ignored.
// \pre both maps are of the same size
void AddDepthErrors(const DepthMap& truth, const DepthMap& mesh,
                    DepthErrors* errors);

// Returns samples of a mesh such that every point of a facet is within the
// spacing of a sample. Facets are bisected recursively at their longest side
// until each part's centroid is close enough to its corners.
//
// \param spacing  scene units, > 0
// \pre facet indices are in range, vertices are finite
// \throw std::invalid_argument for more than about 10^9 samples
std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing);

// Keeps one point for each voxel of a grid through the origin: the one nearest
// to the voxel's center. The result does not depend on the order of the points.
//
// DTU's evaluation [Jensen2014] instead visits points in random order and drops
// all others within the spacing; the density is nearly the same, without
// randomness.
//
// \param spacing  side of the voxels, scene units, > 0
// \param points  [P], scene units
// \throw std::invalid_argument if a point is more than 2^31 voxels from the
//        origin on an axis, or not finite
void DownsampleByVoxels(double spacing, std::vector<Eigen::Vector3f>* points);

// Statistics of distances; without distances, all but the counts are NaN.
struct DistanceStatistics {
  size_t num_samples = 0;
  size_t num_beyond = 0;    // at the maximum distance or beyond
  double mean = 0;          // scene units
  double median = 0;        // mean of the middle two of an even number
  double percentile90 = 0;  // interpolated
};

// \param distances     scene units, clipped at max_distance already
// \param max_distance  scene units
// \param drop_beyond   ignore distances of max_distance, as DTU's own
//        evaluation does. Surface that is far off or missing then costs
//        nothing.
DistanceStatistics Summarize(std::vector<double> distances, double max_distance,
                             bool drop_beyond);

struct MeshEvaluationOptions {
  // A ray is cast through every stride-th pixel of every stride-th row of the
  // views, px, 1 to 1000. The default is chosen by hand.
  int stride = 3;

  // Side of the voxels with one sample each, scene units.
  // 0: 0.001 of the diagonal of the truth's bounding box. DTU has 0.2 mm.
  double spacing = 0;

  // Distances are clipped here, scene units. 0: 0.05 of the diagonal. DTU has
  // 20 mm.
  double max_distance = 0;

  // Leave out distances beyond instead, as DTU's own evaluation does.
  bool drop_beyond = false;

  // Depths with smaller errors are correct, scene units, > 0. Defaults of
  // [HuMordohai2012], if the scene's unit is a meter.
  std::vector<double> depth_thresholds = {0.02, 0.1};
};

// The part of space that DTU's scanner observed [Jensen2014]: a voxel grid, as
// in ObsMask*.mat.
struct ObservabilityMask {
  std::array<size_t, 3> size{};     // X, Y, Z
  std::vector<uint8_t> voxels;      // [X, Y, Z], z fastest; not 0: observable
  Eigen::Vector3d origin{0, 0, 0};  // center of the first voxel
  double resolution = 1;            // side of a voxel, scene units

  // Whether the nearest voxel is observable; false outside of the grid.
  bool Contains(const Eigen::Vector3f& point) const;
};

// The part of space in which a mesh and the truth are compared.
struct Observability {
  // Samples of the mesh outside do not count.
  std::optional<ObservabilityMask> mask;

  // Samples of both outside do not count.
  std::optional<Region> region;

  // Samples of the truth with a x + b y + c z + d <= 0 do not count: the ground
  // below the object. (a, b, c, d), as in DTU's Plane*.mat.
  std::optional<Eigen::Vector4d> ground_plane;

  // Erase the samples, world frame, that do not count.
  void RestrictMesh(std::vector<Eigen::Vector3f>* samples) const;
  void RestrictTruth(std::vector<Eigen::Vector3f>* samples) const;

  // Drops the true depths of a view outside of the region.
  void RestrictDepths(const View& view, DepthMap* depths) const;
};

// Ground truth: a surface, points of it (no facets), or depth maps.
struct Truth {
  TriangleMesh surface;

  // If set, replaces the surface: the depth map of the whole image of a view,
  // by its index; empty if there is none.
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
  size_t num_views = 0;  // only surface that they see counts; 0: all counts
  size_t num_views_without_depths = 0;        // views without a true depth map
  std::optional<SurfaceDistances> distances;  // unless depth maps are the truth
  std::optional<DepthErrors> depths;  // if there are views, and surface or maps
};

// Compares a mesh with the truth.
//
// With views, only surface that they see counts (docs/method.md, section 8.3):
// each sampled pixel whose ray meets the truth gives a sample of the truth and,
// if it meets the mesh, one of the mesh. If the truth is points, all points
// inside the image of a view count, even if occluded, and every hit of the
// mesh. Without views, the whole surfaces count.
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
// scene units; max_distance if it is farther or not finite.
// \pre truth has no depth_maps
std::vector<double> VertexErrors(const TriangleMesh& mesh, const Truth& truth,
                                 double max_distance);

}  // namespace colmap_ext
