#include "delaunay/thinning.h"

#include <array>
#include <cmath>
#include <utility>

#include "delaunay/insert_points.h"
#include "delaunay/point_inserter.h"

namespace colmap_ext {
namespace {

// Tells whether a point is near enough to all four vertices of its cell, in all
// of its views, to be left out.
class ThinningRule {
 public:
  ThinningRule(const PointCloud& cloud, const std::vector<View>& views,
               const ThinningOptions& options)
      : cloud_(cloud),
        views_(views),
        max_proj_dist_squared_(options.max_proj_dist * options.max_proj_dist),
        max_depth_dist_(options.max_depth_dist) {}

  // \param corners  points
  bool IsRedundant(uint32_t point,
                   const std::array<uint32_t, 4>& corners) const {
    for (const uint32_t index : cloud_.views[point]) {
      const View& view = views_[index];
      const Eigen::Vector3d local =
          view.CamFromWorld(cloud_.positions[point].cast<double>());
      for (const uint32_t corner : corners) {
        if (!IsNear(view, local, corner)) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  bool IsNear(const View& view, const Eigen::Vector3d& local,
              uint32_t vertex_point) const {
    const Eigen::Vector3d other =
        view.CamFromWorld(cloud_.positions[vertex_point].cast<double>());
    if (local.z() <= 0 || other.z() <= 0 ||
        std::abs(local.z() / other.z() - 1) > max_depth_dist_) {
      return false;
    }
    return (view.ImageFromCam(local) - view.ImageFromCam(other))
               .squaredNorm() <= max_proj_dist_squared_;
  }

  const PointCloud& cloud_;
  const std::vector<View>& views_;
  double max_proj_dist_squared_;
  double max_depth_dist_;
};

// That corner of a cell which is nearest to a point.
uint32_t NearestCorner(const PointCloud& cloud, uint32_t point,
                       const std::array<uint32_t, 4>& corners) {
  const auto& position = cloud.positions[point];
  uint32_t nearest = corners[0];
  for (const uint32_t corner : corners) {
    if ((cloud.positions[corner] - position).squaredNorm() <
        (cloud.positions[nearest] - position).squaredNorm()) {
      nearest = corner;
    }
  }
  return nearest;
}

// Leaves out points that fall into a cell near whose corners they lie.
class Thinner {
 public:
  Thinner(const PointCloud& cloud, const std::vector<View>& views,
          const ThinningOptions& options, const std::vector<uint32_t>& points,
          std::vector<uint32_t>* representatives)
      : cloud_(cloud),
        points_(points),
        rule_(cloud, views, options),
        representatives_(representatives) {}

  // \param index  into points
  // \return whether the point is redundant in a cell with these vertices
  bool LeavesOut(uint32_t index,
                 const std::array<uint32_t, 4>& vertices) const {
    std::array<uint32_t, 4> corners;
    for (int i = 0; i < 4; ++i) {
      if (vertices[i] == kInfiniteVertex) {
        return false;
      }
      corners[i] = points_[vertices[i]];
    }
    const uint32_t point = points_[index];
    if (!rule_.IsRedundant(point, corners)) {
      return false;
    }
    (*representatives_)[point] = NearestCorner(cloud_, point, corners);
    return true;
  }

 private:
  const PointCloud& cloud_;
  const std::vector<uint32_t>& points_;
  ThinningRule rule_;
  std::vector<uint32_t>* representatives_;
};

}  // namespace

void InsertThinned(const PointCloud& cloud, const std::vector<View>& views,
                   const ThinningOptions& options,
                   const std::vector<uint32_t>& points,
                   const std::vector<uint32_t>& order,
                   std::vector<uint32_t>* representatives,
                   const Progress& progress, GrowingComplex* complex) {
  const Thinner thinner(cloud, views, options, points, representatives);
  const std::array<uint32_t, 4> simplex = StartComplex(order, complex);
  PointInserter inserter(0, static_cast<uint32_t>(points.size()), complex);
  // Before the points span a volume there is no cell to fall into.
  bool spans_volume = false;
  uint32_t hint = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i % 65536 == 0) {
      Report(progress, kTriangulatingStage,
             static_cast<double>(i) / static_cast<double>(order.size()));
    }
    const uint32_t point = order[i];
    if (complex->vertex_cells[point] != kNone) {
      spans_volume = spans_volume || point == simplex[3];
      continue;
    }
    const uint32_t cell = inserter.Locate(point, hint);
    if (spans_volume &&
        thinner.LeavesOut(point, complex->cells[cell].vertices)) {
      hint = cell;
      continue;
    }
    hint = InsertPoint(point, cell, &inserter, complex);
  }
  complex->free_cells = std::move(inserter.free_cells());
}

}  // namespace colmap_ext
