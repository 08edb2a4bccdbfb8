#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

// Geometric predicates on small integer coordinates, in integers: what the
// floating point ones are compared with.
namespace colmap_ext {

__extension__ using Int128 = __int128;

using IntVector = Eigen::Matrix<int64_t, 3, 1>;

// \pre coordinates are integers
inline IntVector ToIntegers(const Eigen::Vector3f& point) {
  return point.cast<int64_t>();
}

// The positions of some vertices.
template <size_t kSize>
std::array<IntVector, kSize> IntegersOf(
    const std::vector<Eigen::Vector3f>& positions,
    const std::array<uint32_t, kSize>& vertices) {
  std::array<IntVector, kSize> points;
  for (size_t i = 0; i < kSize; ++i) {
    points[i] = ToIntegers(positions[vertices[i]]);
  }
  return points;
}

inline Int128 Determinant(const IntVector& a, const IntVector& b,
                          const IntVector& c) {
  const auto minor = [&](int i, int j) {
    return Int128{b[i]} * c[j] - Int128{b[j]} * c[i];
  };
  return a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1);
}

inline int Sign(Int128 value) { return (value > 0) - (value < 0); }

inline int ExactOrientation(const IntVector& a, const IntVector& b,
                            const IntVector& c, const IntVector& d) {
  return Sign(Determinant(b - a, c - a, d - a));
}

// 1 where e lies within the sphere through a, b, c and d, -1 outside of it.
// \pre the tetrahedron is positively oriented, coordinates are less than 2^20
inline int ExactInSphere(const IntVector& a, const IntVector& b,
                         const IntVector& c, const IntVector& d,
                         const IntVector& e) {
  const IntVector p = a - e;
  const IntVector q = b - e;
  const IntVector r = c - e;
  const IntVector s = d - e;
  const Int128 det = p.squaredNorm() * Determinant(q, r, s) -
                     q.squaredNorm() * Determinant(p, r, s) +
                     r.squaredNorm() * Determinant(p, q, s) -
                     s.squaredNorm() * Determinant(p, q, r);
  return Sign(det);
}

}  // namespace colmap_ext
