#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// The far ends of rays that meet no surface on their way, [N] each: what they
// pass through is free space, and nothing is known of what lies at their ends.
struct RayEnds {
  std::vector<Eigen::Vector3f> positions;  // world frame
  std::vector<uint32_t> views;             // that the rays come from
  std::vector<float> weights;              // of their votes

  size_t size() const { return positions.size(); }

  void Add(const RayEnds& others);
};

// Rays of a view that pass through the same square of so many pixels are one,
// with the sum of their weights. A choice: half of the distance within which
// points are thinned by default.
inline constexpr double kRayEndSpacing = 10;

// How far beyond the region points are kept, so that the surface goes on to
// its border, scene units: a share of its diagonal. A choice.
double MarginOf(const Region& region);

// Drops the points that lie further from a region than its margin.
// \param weights [P] of the points' rays
// \return where the dropped points' rays that pass through the region leave
//         its margin.
RayEnds CropCloud(const Region& region, const std::vector<View>& views,
                  const std::vector<float>& weights, PointCloud* cloud);

// A cloud with ends of rays behind its points, each seen by its view.
PointCloud AppendEnds(const PointCloud& cloud, const RayEnds& ends);

}  // namespace colmap_ext
