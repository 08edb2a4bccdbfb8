#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/depth_map.h"
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

// Returns every stride-th pixel of a map of the whole image.
// \param stride  px, > 0
// \pre map.stride == 1
DepthMap Subsample(const DepthMap& map, int stride);

// Returns the points of `depths` where `mask` has a depth too, world frame, row
// by row.
// \pre both are of the same size
std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view);

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

}  // namespace colmap_ext
