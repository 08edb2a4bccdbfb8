#pragma once

#include <Eigen/Core>

namespace colmap_ext {

// Exact signs of determinants of points whose coordinates are floats. Doubles
// decide where their rounding can not matter; else the determinant's terms,
// products of two or three floats, are added up without rounding.

// Returns on which side of the plane through a, b and c a point d lies: the
// sign of det(a - d, b - d, c - d), 0 where they lie in one plane. It is 1
// below the plane if the corners run counter-clockwise seen from above.
// \pre all coordinates are finite
int Side(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
         const Eigen::Vector3f& c, const Eigen::Vector3f& d);

// Returns the sense in which a, b and c run, seen against an axis: the sign of
// that component of (b - a) x (c - a).
// \param axis  0, 1 or 2
// \pre all coordinates are finite
int Turn(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
         const Eigen::Vector3f& c, int axis);

// Whether three points lie on one line, or on one spot.
// \pre all coordinates are finite
bool AreCollinear(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                  const Eigen::Vector3f& c);

}  // namespace colmap_ext
