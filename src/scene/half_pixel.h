#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// COLMAP's camera models put the centre of the first pixel at (0.5, 0.5), but
// its stereo and fusion [Schoenberger2016] back-project integer pixel indices:
// fused points lie half a pixel up and left in every view (docs/method.md,
// section 1.1).
//
// Returns [P] what has to be added to each point of the cloud, to first order:
// world frame, scene units; zero for a point without views.
// \param depth_map_scales  [views] width of each view's depth map over that of
//        its image; empty if all are 1
// \pre view indices < views.size()
std::vector<Eigen::Vector3f> HalfPixelOffsets(
    const PointCloud& cloud, const std::vector<View>& views,
    const std::vector<double>& depth_map_scales = {});

// The share of HalfPixelOffsets() that a workspace itself shows: 1 if its fused
// points have the whole error, 0 if they have none.
struct HalfPixelSlope {
  double slope = 0;
  double standard_error = 0;
  size_t num_points = 0;  // sparse points that took part; 0 if there are too
                          // few to say anything, slope and error are 0 then
};

// Regresses the distance of sparse points from the fused surface, along its
// normal, on the distance that the offsets predict there (docs/method.md,
// section 1.1). Sparse points come from features, which do not have the error.
// \param offsets  [P] HalfPixelOffsets() of the cloud
// \param sparse_points  world frame, scene units
HalfPixelSlope RegressHalfPixel(
    const PointCloud& cloud, const std::vector<Eigen::Vector3f>& offsets,
    const std::vector<Eigen::Vector3f>& sparse_points);

// Returns the factor for the offsets: the mean of the nominal slope 1 and the
// measured one, weighted by their inverse variances. So clouds of other stereo
// are corrected too.
double CalibratedScale(const HalfPixelSlope& slope);

}  // namespace colmap_ext
