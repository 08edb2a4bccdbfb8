#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

namespace colmap_ext {

// The order of positions by x, then y, then z.
inline bool IsLower(const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
}

// Exact geometric predicates (CGAL's filtered kernel).

// The sign of det(b - a, c - a, d - a): whether d lies on the side of the plane
// abc that its right-handed normal points to; 0: in the plane.
int Orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c, const Eigen::Vector3d& d);
int Orientation(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                const Eigen::Vector3f& c, const Eigen::Vector3f& d);

// Whether three points lie on one line, or at one position.
bool AreCollinear(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                  const Eigen::Vector3f& c);

// Whether p and q lie in one plane with the edge from a to b, and on one side
// of it.
// \pre a, b and p are not collinear
bool AreOnOneSide(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                  const Eigen::Vector3f& p, const Eigen::Vector3f& q);

using Triangle = std::array<Eigen::Vector3f, 3>;

// Whether two triangles have a point in common.
// \pre they have an area
bool TrianglesMeet(const Triangle& a, const Triangle& b);

// Whether the segment from p to q and a triangle have a point in common.
// \pre p != q, the triangle has an area
bool SegmentMeetsTriangle(const Eigen::Vector3f& p, const Eigen::Vector3f& q,
                          const Triangle& triangle);

// The side on which the line from `origin` to `target` passes the directed line
// from u to v: the sign of det(target - origin, u - origin, v - origin), with
// the target moved by (e, e^2, e^3), e infinitesimal and positive (simulation
// of simplicity [Edelsbrunner1990]). All answers for one line are
// those for one line in general position; zero is returned only if origin, u
// and v are collinear.
int RaySideExact(const Eigen::Vector3d& origin, const Eigen::Vector3d& target,
                 const Eigen::Vector3d& u, const Eigen::Vector3d& v);

// Where the line from `origin` to `target` crosses the plane abc, as a multiple
// of the way to the target: the double next to the exact value; 0 where the
// line is parallel to the plane.
double CrossingOfPlane(const Eigen::Vector3d& origin,
                       const Eigen::Vector3d& target, const Eigen::Vector3d& a,
                       const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// The centre of the sphere through o, a, b and c, relative to o: the doubles
// next to the exact values.
// \pre the points span a volume
Eigen::Vector3d CenterFrom(const Eigen::Vector3f& o, const Eigen::Vector3f& a,
                           const Eigen::Vector3f& b, const Eigen::Vector3f& c);

// Whether p lies inside the sphere through a, b, c and d. For points on the
// sphere a symbolic perturbation decides [Devillers2011]. It depends only on
// the positions, so that the Delaunay tetrahedralization is unique.
// \pre Orientation(a, b, c, d) > 0, p is none of them
bool IsInSphere(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                const Eigen::Vector3f& c, const Eigen::Vector3f& d,
                const Eigen::Vector3f& p);

// Whether p lies inside the circle through a, b and c, perturbed alike.
// \pre all lie in a plane, a, b and c not on a line, p is none of them
bool IsInCircle(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                const Eigen::Vector3f& c, const Eigen::Vector3f& p);

}  // namespace colmap_ext
