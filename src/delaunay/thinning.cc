#include "delaunay/thinning.h"

#include <algorithm>
#include <limits>
#include <span>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/rows.h"
#include "delaunay/growing_complex.h"
#include "scene/point_tree.h"

namespace colmap_ext {
namespace {

// Of max_proj_dist. A choice.
constexpr double kDistanceShare = 0.2;

using Positions = std::vector<Eigen::Vector3f>;

// How near a vertex has to be for the point to be left out, scene units; 0 if
// no view sees it.
float ThinningDistance(const PointCloud& cloud, const std::vector<View>& views,
                       const ThinningOptions& options, uint32_t point) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double distance = kInfinity;
  for (const uint32_t index : cloud.views[point]) {
    const View& view = views[index];
    const double depth =
        view.CamFromWorld(cloud.positions[point].cast<double>()).z();
    const double of_depth = std::min(
        kDistanceShare * options.max_proj_dist / std::max(view.fx, view.fy),
        options.max_depth_dist);
    if (depth > 0) {
      distance = std::min(distance, depth * of_depth);
    }
  }
  return distance < kInfinity ? static_cast<float>(distance) : 0;
}

Positions Pick(const Positions& points, const std::vector<uint32_t>& indices) {
  Positions picked;
  for (const uint32_t index : indices) {
    picked.push_back(points[index]);
  }
  return picked;
}

// [P] 1: the point is kept. Rounds of the insertion order follow each other:
// most points of one are near what is kept of the rounds before, and few are
// left that may be near each other.
std::vector<uint8_t> KeepApart(const Positions& points,
                               const std::vector<float>& distances) {
  std::vector<uint8_t> is_kept(points.size(), 0);
  Positions kept;
  const std::vector<uint32_t> order = InsertionOrder(points.size());
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::is_sorted_until(begin, order.end());
    const std::span<const uint32_t> round(begin, end);
    const PointTree before(kept);
    const std::vector<uint32_t> far =
        MakeRows<uint32_t>(round.size(), [&](size_t i, auto* row) {
          const uint32_t point = round[i];
          if (before.Nearest(points[point], 1, distances[point]).empty()) {
            row->push_back(point);
          }
        }).values;
    const Positions places = Pick(points, far);
    const PointTree among(places);
    const auto near_earlier =
        MakeRows<uint32_t>(far.size(), [&](size_t i, auto* row) {
          for (const uint32_t j : among.Within(places[i], distances[far[i]])) {
            if (j < i) {
              row->push_back(far[j]);
            }
          }
        });
    for (size_t i = 0; i < far.size(); ++i) {
      if (std::ranges::none_of(near_earlier[i], [&](uint32_t other) {
            return is_kept[other] != 0;
          })) {
        is_kept[far[i]] = 1;
        kept.push_back(places[i]);
      }
    }
    begin = end;
  }
  return is_kept;
}

}  // namespace

ThinnedPoints ThinPoints(const PointCloud& cloud,
                         const std::vector<View>& views,
                         const ThinningOptions& options) {
  std::vector<uint32_t> representatives;
  const std::vector<uint32_t> points =
      DistinctPoints(cloud.positions, &representatives);
  const Positions positions = Pick(cloud.positions, points);
  std::vector<float> distances(points.size(), 0);
  std::vector<uint8_t> is_kept(points.size(), 1);
  if (options.max_proj_dist > 0 && options.max_depth_dist > 0) {
    tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
      distances[i] = ThinningDistance(cloud, views, options, points[i]);
    });
    is_kept = KeepApart(positions, distances);
  }
  ThinnedPoints thinned;
  thinned.num_duplicate_points = cloud.size() - points.size();
  thinned.point_vertices.assign(cloud.size(), kNone);
  for (const uint32_t i : Marked(is_kept)) {
    thinned.point_vertices[points[i]] =
        static_cast<uint32_t>(thinned.vertex_points.size());
    thinned.vertex_points.push_back(points[i]);
  }
  thinned.positions = Pick(cloud.positions, thinned.vertex_points);
  const PointTree tree(thinned.positions);
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    if (is_kept[i] == 0) {
      thinned.point_vertices[points[i]] =
          tree.Nearest(positions[i], 1, distances[i])[0];
    }
  });
  for (uint32_t point = 0; point < cloud.size(); ++point) {
    thinned.point_vertices[point] =
        thinned.point_vertices[representatives[point]];
  }
  return thinned;
}

}  // namespace colmap_ext
