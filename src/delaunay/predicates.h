#pragma once

#include <Eigen/Core>

namespace colmap_ext {

// Exact geometric predicates on double coordinates (CGAL's filtered kernel).

// The sign of det(b - a, c - a, d - a): whether d lies on the side of the plane
// abc that its right-handed normal points to.
int Orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c, const Eigen::Vector3d& d);

// The side on which the line from `origin` to `target` passes the directed line
// from u to v: the sign of det(target - origin, u - origin, v - origin), with
// the target moved by (e, e^2, e^3), e infinitesimal and positive (simulation
// of simplicity [Edelsbrunner1990]). All answers for one line are
// those for one line in general position; zero is returned only where origin, u
// and v are collinear, which no target can tell apart.
int RaySideExact(const Eigen::Vector3d& origin, const Eigen::Vector3d& target,
                 const Eigen::Vector3d& u, const Eigen::Vector3d& v);

}  // namespace colmap_ext
