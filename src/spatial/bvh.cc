#include "spatial/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

constexpr int kNumBins = 16;            // as [Wald2007] has them
constexpr uint32_t kMaxLeafFacets = 4;  // a choice

using Eigen::Vector3d;
using Eigen::Vector3f;
using Box = Eigen::AlignedBox3f;

float HalfArea(const Box& box) {
  if (box.isEmpty()) {
    return 0;
  }
  const Vector3f d = box.sizes();
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

bool Any(Int4 mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

Float4 Min(Float4 a, Float4 b) { return a < b ? a : b; }
Float4 Max(Float4 a, Float4 b) { return a > b ? a : b; }

// The corners' weights of the point of a facet that is nearest to v: the foot
// of the perpendicular if it lies on the facet, else the nearest point of a
// side. Facets without area are no special case: nothing is divided by 0.
// \param v, edge1, edge2  from the first corner
Vector3d NearestWeights(const Vector3d& v, const Vector3d& edge1,
                        const Vector3d& edge2) {
  const Vector3d normal = edge1.cross(edge2);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0) {
    const double weight1 = normal.dot(v.cross(edge2)) / area_squared;
    const double weight2 = normal.dot(edge1.cross(v)) / area_squared;
    if (weight1 >= 0 && weight2 >= 0 && weight1 + weight2 <= 1) {
      return {std::max(0.0, 1 - weight1 - weight2), weight1, weight2};
    }
  }
  const Vector3d origin = Vector3d::Zero();
  const double first = NearestOnSegment(origin, edge1, v);
  const double second = NearestOnSegment(edge1, edge2, v);
  const double third = NearestOnSegment(origin, edge2, v);
  const Vector3d sides[] = {
      {1 - first, first, 0}, {0, 1 - second, second}, {1 - third, 0, third}};
  return *std::ranges::min_element(sides, {}, [&](const Vector3d& weights) {
    return (weights[1] * edge1 + weights[2] * edge2 - v).squaredNorm();
  });
}

}  // namespace

struct Bvh::Builder {
  std::vector<Box> boxes;         // [F]
  std::vector<Vector3f> centers;  // [F], of the boxes
  std::vector<Node> nodes;
  std::vector<uint32_t> order;  // [F]

  // The cheapest plane between bins, as the first facet of its second half in
  // a reordered [first, last); `first` if no plane parts anything.
  uint32_t Split(uint32_t first, uint32_t last, int* axis) {
    Box bounds;
    for (uint32_t i = first; i < last; ++i) {
      bounds.extend(centers[order[i]]);
    }
    bounds.sizes().maxCoeff(axis);
    const float origin = bounds.min()[*axis];
    const float extent = bounds.sizes()[*axis];
    if (!(extent > 0)) {
      return first;
    }
    const auto bin_of = [&](uint32_t facet) {
      const float t = (centers[facet][*axis] - origin) / extent;
      return std::min(kNumBins - 1, static_cast<int>(t * kNumBins));
    };
    std::array<Box, kNumBins> boxes_of;
    std::array<uint32_t, kNumBins> counts{};
    for (uint32_t i = first; i < last; ++i) {
      const int bin = bin_of(order[i]);
      boxes_of[bin].extend(boxes[order[i]]);
      ++counts[bin];
    }
    const int best = CheapestBin(boxes_of, counts);
    const auto middle =
        std::partition(order.begin() + first, order.begin() + last,
                       [&](uint32_t facet) { return bin_of(facet) < best; });
    return middle - order.begin();
  }

  static int CheapestBin(const std::array<Box, kNumBins>& boxes_of,
                         const std::array<uint32_t, kNumBins>& counts) {
    std::array<float, kNumBins> cost{};  // of a split before each bin
    Box left, right;
    uint32_t num_left = 0, num_right = 0;
    for (int bin = 1; bin < kNumBins; ++bin) {
      left.extend(boxes_of[bin - 1]);
      cost[bin] += HalfArea(left) * (num_left += counts[bin - 1]);
      right.extend(boxes_of[kNumBins - bin]);
      cost[kNumBins - bin] +=
          HalfArea(right) * (num_right += counts[kNumBins - bin]);
    }
    return std::min_element(cost.begin() + 1, cost.end()) - cost.begin();
  }

  void Build(uint32_t first, uint32_t last, int depth) {
    const size_t index = nodes.size();
    Box box;
    for (uint32_t i = first; i < last; ++i) {
      box.extend(boxes[order[i]]);
    }
    nodes.push_back(
        {box.min(), box.max(), first, static_cast<uint16_t>(last - first), 0});
    if (last - first <= kMaxLeafFacets) {
      return;
    }
    int axis = 0;
    uint32_t middle = Split(first, last, &axis);
    // Facets on one spot, or a tree as deep as the stack: halves do.
    if (middle == first || middle == last || depth > kMaxDepth / 2) {
      middle = first + (last - first) / 2;
    }
    Build(first, middle, depth + 1);
    nodes[index].next = nodes.size();
    nodes[index].num_facets = 0;
    nodes[index].axis = axis;
    Build(middle, last, depth + 1);
  }
};

Bvh::Bvh(const TriangleMesh& mesh) {
  Builder builder;
  for (uint32_t facet = 0; facet < mesh.facets.size(); ++facet) {
    builder.boxes.push_back(BoxOf(mesh, facet));
    builder.centers.push_back(builder.boxes.back().center());
  }
  builder.order = Iota(mesh.facets.size());
  if (!mesh.facets.empty()) {
    builder.Build(0, mesh.facets.size(), 0);
  }
  nodes_ = std::move(builder.nodes);
  facets_ = std::move(builder.order);
  corners_.reserve(facets_.size());
  for (const uint32_t f : facets_) {
    const auto [a, b, c] = CornersOf(mesh, mesh.facets[f]);
    corners_.push_back({a, b - a, c - a});
  }
}

bool Bvh::MeetsBox(const Node& node, const RayPacket& rays,
                   const Float4 (&inverse)[3], const Float4& nearest) {
  // Each distance has three roundings of 2^-24.
  constexpr float kSlack = 1.000001f;
  Float4 enter = Float4{} + rays.min_distance;
  Float4 leave = nearest;
  for (int i = 0; i < 3; ++i) {
    const Float4 low = (node.min[i] - rays.origin[i]) * inverse[i];
    const Float4 high = (node.max[i] - rays.origin[i]) * inverse[i];
    const Int4 forward = inverse[i] > 0;
    // A distance is NaN, 0 times infinity, where the ray lies in that plane of
    // the box; it then bounds nothing: Max and Min return their second value.
    enter = Max(forward ? low : high, enter);
    leave = Min(forward ? high : low, leave);
  }
  return Any(enter <= leave * kSlack);
}

void Bvh::IntersectFacet(const Corner& c, uint32_t facet, const RayPacket& rays,
                         HitPacket* hit) {
  // Tolerance of barycentric coordinates, so that no ray passes between two
  // facets; a choice: about 80 roundings of floats.
  constexpr float kEdge = 1e-5f;
  const Vector3f s = rays.origin - c.point;
  const Vector3f q = s.cross(c.edge1);
  const Float4 px = rays.y * c.edge2.z() - rays.z * c.edge2.y();
  const Float4 py = rays.z * c.edge2.x() - rays.x * c.edge2.z();
  const Float4 pz = rays.x * c.edge2.y() - rays.y * c.edge2.x();
  const Float4 scale =
      1 / (c.edge1.x() * px + c.edge1.y() * py + c.edge1.z() * pz);
  const Float4 u = (s.x() * px + s.y() * py + s.z() * pz) * scale;
  const Float4 v = (rays.x * q.x() + rays.y * q.y() + rays.z * q.z()) * scale;
  const Float4 t = c.edge2.dot(q) * scale;
  const Int4 met = (u >= -kEdge) & (v >= -kEdge) & (u + v <= 1 + kEdge) &
                   (t > rays.min_distance) & (t < hit->distance);
  hit->distance = met ? t : hit->distance;
  hit->facet = met ? Int4{} + static_cast<int32_t>(facet) : hit->facet;
}

HitPacket Bvh::Intersect(const RayPacket& rays) const {
  HitPacket hit{Float4{} + rays.max_distance, Int4{} - 1};
  const Float4 inverse[3] = {1 / rays.x, 1 / rays.y, 1 / rays.z};
  std::array<uint32_t, kMaxDepth + 2> stack;
  int size = 0;
  if (!nodes_.empty()) {
    stack[size++] = 0;
  }
  while (size > 0) {
    const uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (!MeetsBox(node, rays, inverse, hit.distance)) {
      continue;
    }
    for (uint32_t i = node.next; i < node.next + node.num_facets; ++i) {
      IntersectFacet(corners_[i], facets_[i], rays, &hit);
    }
    if (node.num_facets == 0) {
      // The child on the side that the first ray comes from is visited first.
      const bool forward = inverse[node.axis][0] > 0;
      stack[size++] = forward ? node.next : index + 1;
      stack[size++] = forward ? index + 1 : node.next;
    }
  }
  return hit;
}

double Bvh::DistanceSquared(const Corner& corner, const Vector3d& point) {
  const Vector3d edge1 = corner.edge1.cast<double>();
  const Vector3d edge2 = corner.edge2.cast<double>();
  const Vector3d v = point - corner.point.cast<double>();
  const Vector3d weights = NearestWeights(v, edge1, edge2);
  return (weights[1] * edge1 + weights[2] * edge2 - v).squaredNorm();
}

double Bvh::DistanceSquared(const Node& node, const Vector3d& point) {
  return (node.min.cast<double>() - point)
      .cwiseMax(point - node.max.cast<double>())
      .cwiseMax(0.0)
      .squaredNorm();
}

template <bool kAny, typename Accepts>
std::pair<double, uint32_t> Bvh::Nearest(const Vector3f& query,
                                         double max_distance,
                                         const Accepts& accepts) const {
  const Vector3d point = query.cast<double>();
  double nearest = max_distance * max_distance;
  uint32_t facet = kNone;
  std::array<std::pair<double, uint32_t>, kMaxDepth + 2> stack;
  int size = 0;
  if (!nodes_.empty()) {
    stack[size++] = {DistanceSquared(nodes_[0], point), 0};
  }
  while (size > 0) {
    const auto [bound, index] = stack[--size];
    if (bound >= nearest) {
      continue;
    }
    const Node& node = nodes_[index];
    for (uint32_t i = node.next; i < node.next + node.num_facets; ++i) {
      const double squared =
          accepts(i) ? DistanceSquared(corners_[i], point) : nearest;
      if (squared < nearest) {
        nearest = squared;
        facet = facets_[i];
        if (kAny) {
          return {nearest, facet};
        }
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
  return {nearest, facet};
}

double Bvh::Distance(const Vector3f& point, double max_distance) const {
  const auto [squared, facet] =
      Nearest<false>(point, max_distance, [](uint32_t) { return true; });
  return facet != kNone ? std::sqrt(squared) : max_distance;
}

uint32_t Bvh::NearestFacet(const Vector3f& point, const Vector3f& normal,
                           double max_distance) const {
  return Nearest<false>(point, max_distance,
                        [&](uint32_t i) { return Faces(i, normal); })
      .second;
}

bool Bvh::IsNear(const Vector3f& point, const Vector3f& normal,
                 double max_distance) const {
  return Nearest<true>(point, max_distance, [&](uint32_t i) {
           return Faces(i, normal);
         }).second != kNone;
}

SurfacePoint NearestPointOfFacet(const TriangleMesh& mesh, uint32_t facet,
                                 const Eigen::Vector3f& position) {
  const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[facet]);
  return {
      facet,
      NearestWeights(position.cast<double>() - a, b - a, c - a).cast<float>()};
}

}  // namespace colmap_ext
