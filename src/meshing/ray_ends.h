#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "delaunay/thinning.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// The far end of a ray that meets no surface on its way: what it passes through
// is free space, and nothing is known of what lies at its end.
struct RayEnd {
  Eigen::Vector3f position;  // world frame
  uint32_t view;             // that the ray comes from
  float weight;              // of its vote
};
using RayEnds = std::vector<RayEnd>;

// Rays of a view that pass through the same square of so many pixels are one,
// with the sum of their weights. A choice: half of the distance within which
// points are thinned by default.
inline constexpr double kRayEndSpacing = 10;

// How far beyond the region points are kept, so that the surface extends
// to its border, scene units: a share of its diagonal. A choice.
double MarginOf(const Region& region);

// Points that vote, and behind them ends of rays.
struct WeightedCloud {
  PointCloud cloud;
  std::vector<float> weights;  // [P] of the votes of each
  size_t num_points = 0;       // that are no ends
};

// Collects the ends of rays to points that are dropped as they lie further from
// a region than its margin: where rays that pass through the region leave the
// margin. Of one view there is one a square of the image, at the first ray.
class RayEndCollector {
 public:
  RayEndCollector(const Region& region, const std::vector<View>& views);

  // Whether a point is dropped.
  bool IsOutside(const Eigen::Vector3f& point) const {
    return !grown_.Contains(point);
  }

  // \param weight  of each observation of the point
  void Add(const Eigen::Vector3f& point, std::span<const uint32_t> views,
           float weight);

  RayEnds Take() { return std::move(ends_); }

 private:
  void AddRay(uint32_t view_index, const Eigen::Vector3d& point, float weight);

  Region region_;
  Region grown_;
  const std::vector<View>& views_;
  std::vector<std::map<std::pair<int, int>, size_t>> squares_;  // [views]
  RayEnds ends_;
};

// Drops some of the points.
// \param is_dropped [P] ends of rays are not dropped
void DropPoints(const std::vector<uint8_t>& is_dropped,
                WeightedCloud* weighted);

// Drops the points that lie further from a region than its margin.
// \param weighted  without ends.
// \return the ends of their rays
RayEnds CropCloud(const Region& region, const std::vector<View>& views,
                  WeightedCloud* weighted);

// The box along the world's axes that holds all points, and a tenth of its size
// more on each side.
// \pre there are points
Region RegionOfCloud(const PointCloud& cloud);

// The same of the box of all points.
Region RegionAround(const Eigen::AlignedBox3f& box);

// The ends of rays through what a mask leaves out: every kRayEndSpacing-th
// pixel of such a row where pixels are masked for so far around that an
// imprecise outline does no harm. They end where they leave a region.
// \param mask  of the view's size, pixels of 0 are masked
RayEnds BackgroundEnds(const Region& region, const View& view,
                       uint32_t view_index, const GrayImage& mask);

// The ends of rays to every kDepthSpacing-th depth of every such row of a depth
// map: four pixels' widths before the depths, since some depths are wrong.
// \param depths  of the view, of any size
std::vector<Eigen::Vector3f> DepthRayEnds(const View& view,
                                          const DepthMap& depths);

// Pixels of the depth map. A choice.
inline constexpr int kDepthSpacing = 8;

// The weight of such a ray's vote, which stands for 64 pixels. A choice.
inline constexpr float kDepthRayWeight = 8;

// Adds ends behind the points, each seen by its view.
void AppendEnds(const RayEnds& ends, WeightedCloud* weighted);

// [V] which vertices are ends of rays; empty: none. Points that were thinned
// out in favour of such a vertex, and ends in favour of a point, vote for
// nothing: their weights become zero.
std::vector<uint8_t> MarkEnds(const ThinnedPoints& thinned,
                              WeightedCloud* weighted);

}  // namespace colmap_ext
