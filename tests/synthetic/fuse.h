#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "tests/synthetic/render.h"
#include "tests/synthetic/stereo.h"

namespace colmap_ext::synthetic {

// Names and defaults of COLMAP's stereo_fusion.
struct FusionOptions {
  // Minimum number of fused pixels to produce a point.
  int min_num_pixels = 5;

  // Maximum distance between a measured and a projected pixel, px.
  double max_reproj_error = 2.0;

  // Maximum relative difference between measured and projected depth.
  double max_depth_error = 0.01;

  // Maximum angular difference of the normals of pixels to be fused, degrees.
  double max_normal_error = 10.0;

  // Outliers that are added, as a share of the points: clumps off the surface,
  // seen by few images.
  double outliers = 0.01;
};

struct FusedPoints {
  PointCloud cloud;                      // colours only where images were given
  std::vector<Eigen::Vector3f> normals;  // [P], world frame, unit
  std::vector<char> is_outlier;          // [P], put there on purpose
};

// Joins depth maps into points by the rules of COLMAP's stereo_fusion: a pixel
// that is left over is a reference; pixels of other images that its point falls
// onto join it when position, depth and normal agree, and bring in those that
// their own points fall onto; the point is the median. One thread, so that the
// result is always the same.
// \param images of all views, or empty
FusedPoints FuseDepthMaps(const std::vector<View>& views,
                          const std::vector<DepthMap>& maps,
                          const std::vector<ColorImage>& images,
                          const FusionOptions& options);

// Adds outliers as FusionOptions says, behind the points that are there.
void AddOutliers(const std::vector<View>& views, double share, uint64_t seed,
                 FusedPoints* points);

}  // namespace colmap_ext::synthetic
