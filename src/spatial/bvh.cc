#include "spatial/bvh.h"

#include <cmath>

#include "base/indices.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

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

Bvh::Bvh(const TriangleMesh& mesh) : FacetTree(mesh, Iota(mesh.facets.size())) {
  std::vector<Box>().swap(boxes_);  // The nodes' boxes do.
  corners_.reserve(facets_.size());
  for (const uint32_t f : facets_) {
    const auto [a, b, c] = CornersOf(mesh, mesh.facets[f]);
    corners_.push_back({a, b - a, c - a});
  }
}

float Bvh::Entry(const Box& box, const RayPacket& rays,
                 const Float4 (&inverse)[3], const Float4& nearest) {
  // Each distance has three roundings of 2^-24.
  constexpr float kSlack = 1.000001f;
  Float4 enter = Float4{} + rays.min_distance;
  Float4 leave = nearest;
  for (int i = 0; i < 3; ++i) {
    const Float4 low = (box.min()[i] - rays.origin[i]) * inverse[i];
    const Float4 high = (box.max()[i] - rays.origin[i]) * inverse[i];
    const Int4 forward = inverse[i] > 0;
    // A distance is NaN, 0 times infinity, where the ray lies in that plane of
    // the box; it then bounds nothing: Max and Min return their second value.
    enter = Max(forward ? low : high, enter);
    leave = Min(forward ? high : low, leave);
  }
  const Float4 entry =
      enter <= leave * kSlack ? enter : Float4{} + rays.max_distance;
  return std::min({entry[0], entry[1], entry[2], entry[3]});
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
  VisitNearestFirst(
      rays.max_distance,
      [&](const Box& box) { return Entry(box, rays, inverse, hit.distance); },
      [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
          IntersectFacet(corners_[i], facets_[i], rays, &hit);
        }
        const Float4& t = hit.distance;
        return std::max({t[0], t[1], t[2], t[3]});
      });
  return hit;
}

double Bvh::DistanceSquared(const Corner& corner, const Vector3d& point) {
  const Vector3d edge1 = corner.edge1.cast<double>();
  const Vector3d edge2 = corner.edge2.cast<double>();
  const Vector3d v = point - corner.point.cast<double>();
  const Vector3d weights = NearestWeights(v, edge1, edge2);
  return (weights[1] * edge1 + weights[2] * edge2 - v).squaredNorm();
}

double Bvh::DistanceSquared(const Box& box, const Vector3d& point) {
  return (box.min().cast<double>() - point)
      .cwiseMax(point - box.max().cast<double>())
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
  VisitNearestFirst(
      nearest, [&](const Box& box) { return DistanceSquared(box, point); },
      [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
          const double squared =
              accepts(i) ? DistanceSquared(corners_[i], point) : nearest;
          if (squared < nearest) {
            nearest = squared;
            facet = facets_[i];
          }
        }
        return kAny && facet != kNone ? 0 : nearest;
      });
  return {nearest, facet};
}

double Bvh::Distance(const Vector3f& point, double max_distance) const {
  const auto [squared, facet] =
      Nearest<false>(point, max_distance, [](size_t) { return true; });
  return facet != kNone ? std::sqrt(squared) : max_distance;
}

uint32_t Bvh::NearestFacet(const Vector3f& point, const Vector3f& normal,
                           double max_distance) const {
  return Nearest<false>(point, max_distance,
                        [&](size_t i) { return Faces(i, normal); })
      .second;
}

bool Bvh::IsNear(const Vector3f& point, const Vector3f& normal,
                 double max_distance) const {
  return Nearest<true>(point, max_distance, [&](size_t i) {
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
