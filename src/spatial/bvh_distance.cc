#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "spatial/bvh.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;

// From a point v to the segment from the origin to `edge`, which may be one
// point.
double SegmentDistanceSquared(const Vector3d& v, const Vector3d& edge) {
  const double length_squared = edge.squaredNorm();
  const double t = length_squared > 0
                       ? std::clamp(v.dot(edge) / length_squared, 0.0, 1.0)
                       : 0;
  return (v - t * edge).squaredNorm();
}

}  // namespace

// To the facet's plane where the foot of the perpendicular lies on the facet,
// else to the nearest of its sides: no division but by what is positive, so
// that facets without area need no care.
double Bvh::DistanceSquared(const Corner& corner, const Vector3d& point) {
  const Vector3d edge1 = corner.edge1.cast<double>();
  const Vector3d edge2 = corner.edge2.cast<double>();
  const Vector3d v = point - corner.point.cast<double>();
  const Vector3d normal = edge1.cross(edge2);
  const double area_squared = normal.squaredNorm();
  const double weight1 = normal.dot(v.cross(edge2));
  const double weight2 = normal.dot(edge1.cross(v));
  if (area_squared > 0 && weight1 >= 0 && weight2 >= 0 &&
      weight1 + weight2 <= area_squared) {
    const double height = normal.dot(v);
    return height * height / area_squared;
  }
  return std::min({SegmentDistanceSquared(v, edge1),
                   SegmentDistanceSquared(v, edge2),
                   SegmentDistanceSquared(v - edge1, edge2 - edge1)});
}

double Bvh::DistanceSquared(const Node& node, const Vector3d& point) {
  return (node.min.cast<double>() - point)
      .cwiseMax(point - node.max.cast<double>())
      .cwiseMax(0.0)
      .squaredNorm();
}

double Bvh::Distance(const Eigen::Vector3f& query, double max_distance) const {
  if (nodes_.empty()) {
    return max_distance;
  }
  const Vector3d point = query.cast<double>();
  double nearest = max_distance * max_distance;
  bool is_found = false;
  std::array<std::pair<double, uint32_t>, kMaxDepth + 2> stack;
  int size = 0;
  stack[size++] = {DistanceSquared(nodes_[0], point), 0};
  while (size > 0) {
    const auto [bound, index] = stack[--size];
    if (bound >= nearest) {
      continue;
    }
    const Node& node = nodes_[index];
    for (uint32_t i = 0; i < node.num_facets; ++i) {
      const double distance = DistanceSquared(corners_[node.next + i], point);
      if (distance < nearest) {
        nearest = distance;
        is_found = true;
      }
    }
    if (node.num_facets == 0) {
      std::pair near{DistanceSquared(nodes_[index + 1], point), index + 1};
      std::pair far{DistanceSquared(nodes_[node.next], point), node.next};
      if (far.first < near.first) {
        std::swap(near, far);
      }
      stack[size++] = far;
      stack[size++] = near;
    }
  }
  return is_found ? std::sqrt(nearest) : max_distance;
}

}  // namespace colmap_ext
