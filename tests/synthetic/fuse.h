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

  // Outliers that are added, as a fraction of the points: clumps off the
  // surface, seen by few images.
  double outliers = 0.01;
};

struct FusedPoints {
  PointCloud cloud;                      // colors only with images
  std::vector<Eigen::Vector3f> normals;  // [P], world frame, unit
  std::vector<char> is_outlier;          // [P], added by AddOutliers()
};

// Fuses depth maps by the rules of COLMAP's stereo_fusion: an unused pixel is a
// reference; the pixels of other images that its point projects to are joined
// if position, depth and normal agree, then those that their points project to;
// the point is the median. Single-threaded, for reproducible results. \param
// images of all views, or empty
FusedPoints FuseDepthMaps(const std::vector<View>& views,
                          const std::vector<DepthMap>& maps,
                          const std::vector<ColorImage>& images,
                          const FusionOptions& options);

// Appends outliers, see FusionOptions.
void AddOutliers(const std::vector<View>& views, double share, uint64_t seed,
                 FusedPoints* points);

}  // namespace colmap_ext::synthetic
