#include "tiles/conflict_zone.h"

#include <array>
#include <cmath>
#include <limits>

#include "delaunay/cell_conflict.h"

namespace colmap_ext {
namespace {

#ifdef __SIZEOF_FLOAT128__
__extension__ using Exact = __float128;
#else
using Exact = long double;
#endif

template <typename T>
using Vector = std::array<T, 3>;

template <typename T>
Vector<T> Cross(const Vector<T>& a, const Vector<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

template <typename T>
T Dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename T>
Vector<T> Difference(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return {static_cast<T>(a.x()) - static_cast<T>(b.x()),
          static_cast<T>(a.y()) - static_cast<T>(b.y()),
          static_cast<T>(a.z()) - static_cast<T>(b.z())};
}

// The centre of the sphere through o, a, b, c relative to o (docs/method.md,
// section 2.2).
// \param reliability  is set to the volume over the product of the edges' sizes
template <typename T>
Eigen::Vector3d Center(const Eigen::Vector3f& o, const Eigen::Vector3f& pa,
                       const Eigen::Vector3f& pb, const Eigen::Vector3f& pc,
                       double* reliability) {
  const Vector<T> a = Difference<T>(pa, o);
  const Vector<T> b = Difference<T>(pb, o);
  const Vector<T> c = Difference<T>(pc, o);
  const Vector<T> bc = Cross(b, c);
  const Vector<T> ca = Cross(c, a);
  const Vector<T> ab = Cross(a, b);
  const T aa = Dot(a, a);
  const T bb = Dot(b, b);
  const T cc = Dot(c, c);
  const T volume = Dot(a, bc);
  *reliability = std::abs(static_cast<double>(volume)) /
                 std::sqrt(static_cast<double>(aa) * static_cast<double>(bb) *
                           static_cast<double>(cc));
  Eigen::Vector3d center;
  for (int i = 0; i < 3; ++i) {
    center[i] = static_cast<double>((aa * bc[i] + bb * ca[i] + cc * ab[i]) /
                                    (2 * volume));
  }
  return center;
}

// Relative to distances from the centre, many times what rounding can do.
constexpr double kRelativeSlack = 1e-8;

}  // namespace

ConflictZone::ConflictZone(const GrowingComplex& complex, uint32_t index) {
  const GrowingComplex::Cell& cell = complex.cells[index];
  const uint32_t infinite = InfiniteCorner(cell);
  const auto corner = [&](uint32_t i) -> const Eigen::Vector3f& {
    return complex.points[cell.vertices[i % 4]];
  };
  is_sphere_ = infinite == 4;
  if (is_sphere_) {
    // Of a flat cell the centre is far off in double precision; products of
    // differences of floats are exact in quadruple precision.
    constexpr double kReliable = 1e-5;
    double reliability = 0;
    Eigen::Vector3d offset = Center<double>(corner(0), corner(1), corner(2),
                                            corner(3), &reliability);
    if (!(reliability > kReliable)) {
      offset = Center<Exact>(corner(0), corner(1), corner(2), corner(3),
                             &reliability);
    }
    center_ = corner(0).cast<double>() + offset;
    radius_squared_ = offset.squaredNorm();
    slack_ = kRelativeSlack *
             (std::sqrt(radius_squared_) + corner(0).cast<double>().norm());
    return;
  }
  // The infinite vertex lies on the positive side of the facet.
  const auto at = [&](uint32_t i) -> Eigen::Vector3d {
    return corner(infinite + i).cast<double>();
  };
  center_ = at(1);
  const Eigen::Vector3d a = at(2) - at(1);
  const Eigen::Vector3d b = at(3) - at(1);
  normal_ = infinite % 2 == 0 ? b.cross(a) : a.cross(b);
  // That of a facet with hardly an area is not known well.
  constexpr double kMinSine = 1e-6;
  has_normal_ = normal_.norm() > kMinSine * a.norm() * b.norm();
  normal_.normalize();
  slack_ = kRelativeSlack * center_.norm();
}

bool ConflictZone::MayTouch(const Eigen::AlignedBox3f& box) const {
  const Eigen::AlignedBox3d wide(box.min().cast<double>(),
                                 box.max().cast<double>());
  if (is_sphere_) {
    const double reach = std::sqrt(radius_squared_) + slack_;
    return wide.squaredExteriorDistance(center_) <= reach * reach;
  }
  if (!has_normal_) {
    return true;
  }
  const Eigen::Vector3d farthest =
      (normal_.array() > 0).select(wide.max(), wide.min());
  return normal_.dot(farthest - center_) >=
         -slack_ - kRelativeSlack * (farthest - center_).norm();
}

double ConflictZone::Depth(const Eigen::Vector3f& point) const {
  const Eigen::Vector3d offset = point.cast<double>() - center_;
  if (is_sphere_) {
    const double reach = std::sqrt(radius_squared_) + slack_;
    return reach - offset.norm();
  }
  if (!has_normal_) {
    return 0;
  }
  return normal_.dot(offset) + slack_ + kRelativeSlack * offset.norm();
}

}  // namespace colmap_ext
