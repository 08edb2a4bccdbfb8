#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The point of a segment that is nearest to p, from 0 at a to 1 at b; 0 where
// they are one point.
template <typename Vector>
typename Vector::Scalar NearestOnSegment(const Vector& a, const Vector& b,
                                         const Vector& p) {
  using Scalar = typename Vector::Scalar;
  const Scalar length_squared = (b - a).squaredNorm();
  return length_squared > 0
             ? std::clamp<Scalar>((p - a).dot(b - a) / length_squared, 0, 1)
             : 0;
}

// A point of a mesh's surface.
struct SurfacePoint {
  uint32_t facet = 0;
  Eigen::Vector3f weights{1, 0, 0};  // of the facet's corners: barycentric, not
                                     // negative, their sum is 1
};

// The point's value of a quantity that the vertices have and that is linear on
// each facet.
// \param values [V] of the vertices
template <typename Values>
auto ValueAt(const SurfacePoint& point, const TriangleMesh& mesh,
             const Values& values) {
  const Facet& facet = mesh.facets[point.facet];
  using Value = typename Values::value_type;
  return Value(point.weights[0] * values[facet[0]] +
               point.weights[1] * values[facet[1]] +
               point.weights[2] * values[facet[2]]);
}

// The points' values, see ValueAt().
// \return [N]
template <typename Values>
Values ValuesAt(const std::vector<SurfacePoint>& points,
                const TriangleMesh& mesh, const Values& values) {
  Values result;
  result.reserve(points.size());
  for (const SurfacePoint& point : points) {
    result.push_back(ValueAt(point, mesh, values));
  }
  return result;
}

// The point of a facet that is nearest to a position.
// \pre facet < F; the position is finite
SurfacePoint NearestPointOfFacet(const TriangleMesh& mesh, uint32_t facet,
                                 const Eigen::Vector3f& position);

}  // namespace colmap_ext
