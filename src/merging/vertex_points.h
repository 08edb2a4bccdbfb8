#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "meshing/finish_surface.h"
#include "scene/point_cloud.h"
#include "tiles/thin_tile.h"

namespace colmap_ext {

// Reads colours, views, supports and ends of some of the plan's vertices, by
// ids, ascending.
using ReadAttributes =
    std::function<TileVertices(const std::vector<uint32_t>&)>;

// The points of a surface's vertices, without positions. Centroids have none.
struct VertexPoints {
  PointCloud cloud;
  std::vector<uint32_t> vertex_points;
  std::vector<float> supports;
  std::vector<uint8_t> is_end;

  SurfacePoints AsSurfacePoints() const {
    return {cloud, vertex_points, supports, is_end};
  }
};

// \param ids  the plan's vertices, ascending; those from `num_plan_vertices` on
//        are centroids
VertexPoints PointsOf(const std::vector<uint32_t>& ids,
                      uint32_t num_plan_vertices, const ReadAttributes& read);

}  // namespace colmap_ext
