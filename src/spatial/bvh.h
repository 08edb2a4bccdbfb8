#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "spatial/facet_tree.h"

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

// Four values side by side, one for each ray of a packet (GCC and Clang).
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

// Four rays from one origin. Distances are in lengths of the directions: depths
// for directions from RayDirection().
struct RayPacket {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();  // scene units
  Float4 x{}, y{}, z{};  // directions, any length but zero
  float min_distance = 0;
  float max_distance = 1e30f;  // beyond any scene

  void SetDirection(int ray, const Eigen::Vector3f& direction) {
    x[ray] = direction.x();
    y[ray] = direction.y();
    z[ray] = direction.z();
  }
};

struct HitPacket {
  Float4 distance;  // of the nearest hit, else the packet's max_distance
  Int4 facet;       // index in the mesh; -1: no hit
};

// A bounding volume hierarchy over the facets of a mesh. Packets of four rays
// meet facets by the test of [Moeller1997].
class Bvh : FacetTree {
 public:
  // Facets may be degenerate: one that repeats a vertex three times is a point.
  // \pre F < 2^31; facet indices are in range, the facets' vertices are finite
  explicit Bvh(const TriangleMesh& mesh);

  // Returns the nearest hit of each ray between min_distance and max_distance,
  // on either side of a facet. Facets without area are not hit.
  HitPacket Intersect(const RayPacket& rays) const;

  // Returns the distance from a point to the nearest facet, scene units: exact
  // but for the rounding of the facets' edges to floats; max_distance if no
  // facet is nearer.
  // \pre the point is finite
  double Distance(const Eigen::Vector3f& point, double max_distance) const;

  // The nearest of the facets that face the way `normal` does, so that the
  // other side of a thin sheet does not count.
  // \return the facet; kNone if none is nearer than max_distance
  // \pre the point is finite
  uint32_t NearestFacet(const Eigen::Vector3f& point,
                        const Eigen::Vector3f& normal,
                        double max_distance) const;

  // Whether NearestFacet() finds any, which takes less time to tell.
  bool IsNear(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
              double max_distance) const;

 private:
  struct Corner {  // the first of a facet, and the edges from it to the others
    Eigen::Vector3f point, edge1, edge2;
  };

  // Where the first ray enters a box before its nearest hit so far; the
  // packet's max_distance where none does.
  static float Entry(const Box& box, const RayPacket& rays,
                     const Float4 (&inverse)[3], const Float4& nearest);
  static void IntersectFacet(const Corner& corner, uint32_t facet,
                             const RayPacket& rays, HitPacket* hit);
  static double DistanceSquared(const Corner& corner,
                                const Eigen::Vector3d& point);
  static double DistanceSquared(const Box& box, const Eigen::Vector3d& point);

  bool Faces(size_t i, const Eigen::Vector3f& normal) const {
    return corners_[i].edge1.cross(corners_[i].edge2).dot(normal) > 0;
  }

  // The squared distance and the index of the nearest facet, or with kAny of
  // any, for which accepts(i) holds, i in the order of the leaves, and which is
  // nearer than max_distance; kNone if there is none.
  template <bool kAny, typename Accepts>
  std::pair<double, uint32_t> Nearest(const Eigen::Vector3f& point,
                                      double max_distance,
                                      const Accepts& accepts) const;

  std::vector<Corner> corners_;  // [F], in the order of the leaves
};

}  // namespace colmap_ext
