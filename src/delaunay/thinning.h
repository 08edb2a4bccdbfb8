#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Which points become vertices: a point is left out where one that is kept is
// nearer to it than a fifth of max_proj_dist covers in the nearest of its
// views, and than max_depth_dist of its depth there. COLMAP's delaunay_mesher
// judges by the cell that a point falls into: with the same options it keeps
// about as many points, less evenly.
struct ThinningOptions {
  double max_proj_dist = 20.0;   // px; 0 keeps every point
  double max_depth_dist = 0.05;  // of the depth, in [0, 1]; 0 keeps every point
};

struct ThinnedPoints {
  std::vector<Eigen::Vector3f> positions;  // [V] of the vertices, distinct,
                                           // along a space-filling curve
  std::vector<uint32_t> vertex_points;  // [V], the cloud's point of each vertex
  std::vector<uint32_t> point_vertices;  // [P], the vertex of each point: its
                                         // own, or the nearest one
  size_t num_duplicate_points = 0;       // at the very position of another
};

// The points that are kept, in a random order (Poisson disk sampling by
// throwing darts [Cook1986]): no point is left out that is far from all
// vertices, and no vertices are near each other. The result depends neither on
// the number of threads nor on anything but the input.
//
// \pre all positions are finite, view indices < views.size()
// \throw std::invalid_argument if the points are too many for 32-bit indices
ThinnedPoints ThinPoints(const PointCloud& cloud,
                         const std::vector<View>& views,
                         const ThinningOptions& options);

}  // namespace colmap_ext
