#include "spatial/predicates.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

namespace colmap_ext {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <typename Scalar>
Kernel::Point_3 ToCgal(const Eigen::Matrix<Scalar, 3, 1>& p) {
  return {p.x(), p.y(), p.z()};
}

// For results that are no signs.
using Number = CGAL::Exact_rational;
using ExactPoint = CGAL::Simple_cartesian<Number>::Point_3;

template <typename Scalar>
ExactPoint ToExact(const Eigen::Matrix<Scalar, 3, 1>& p) {
  return {p.x(), p.y(), p.z()};
}

// CGAL's perturbed predicates.
class Perturbed : public CGAL::Delaunay_triangulation_3<Kernel> {
 public:
  using Delaunay_triangulation_3::coplanar_side_of_bounded_circle;
  using Delaunay_triangulation_3::side_of_oriented_sphere;

  static const Perturbed& Instance() {
    static const Perturbed instance;
    return instance;
  }
};

Kernel::Triangle_3 ToCgal(const Triangle& triangle) {
  return {ToCgal(triangle[0]), ToCgal(triangle[1]), ToCgal(triangle[2])};
}

// The sign of the component `axis` of (b - a) x (c - a).
int Turn(const Vector3d& a, const Vector3d& b, const Vector3d& c, int axis) {
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  return CGAL::orientation(Kernel::Point_2(a[i], a[j]),
                           Kernel::Point_2(b[i], b[j]),
                           Kernel::Point_2(c[i], c[j]));
}

}  // namespace

int Orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                const Vector3d& d) {
  return CGAL::orientation(ToCgal(a), ToCgal(b), ToCgal(c), ToCgal(d));
}

int Orientation(const Vector3f& a, const Vector3f& b, const Vector3f& c,
                const Vector3f& d) {
  return CGAL::orientation(ToCgal(a), ToCgal(b), ToCgal(c), ToCgal(d));
}

bool AreCollinear(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  return CGAL::collinear(ToCgal(a), ToCgal(b), ToCgal(c));
}

bool AreOnOneSide(const Vector3f& a, const Vector3f& b, const Vector3f& p,
                  const Vector3f& q) {
  return Orientation(a, b, p, q) == 0 &&
         CGAL::coplanar_orientation(ToCgal(a), ToCgal(b), ToCgal(p),
                                    ToCgal(q)) == CGAL::POSITIVE;
}

bool TrianglesMeet(const Triangle& a, const Triangle& b) {
  return CGAL::do_intersect(ToCgal(a), ToCgal(b));
}

bool SegmentMeetsTriangle(const Vector3f& p, const Vector3f& q,
                          const Triangle& triangle) {
  return CGAL::do_intersect(Kernel::Segment_3(ToCgal(p), ToCgal(q)),
                            ToCgal(triangle));
}

int RaySideExact(const Vector3d& origin, const Vector3d& target,
                 const Vector3d& u, const Vector3d& v) {
  int sign = Orientation(origin, target, u, v);
  for (int axis = 0; sign == 0 && axis < 3; ++axis) {
    sign = Turn(origin, u, v, axis);
  }
  return sign;
}

double CrossingOfPlane(const Vector3d& origin, const Vector3d& target,
                       const Vector3d& a, const Vector3d& b,
                       const Vector3d& c) {
  const auto volume_to = [&](const Vector3d& p) -> Number {
    return CGAL::volume(ToExact(a), ToExact(b), ToExact(c), ToExact(p));
  };
  const Number before = volume_to(origin);
  const Number way = before - volume_to(target);
  return way != 0 ? CGAL::to_double(Number(before / way)) : 0;
}

Vector3d CenterFrom(const Vector3f& o, const Vector3f& a, const Vector3f& b,
                    const Vector3f& c) {
  const auto center =
      CGAL::circumcenter(ToExact(o), ToExact(a), ToExact(b), ToExact(c)) -
      ToExact(o);
  return {CGAL::to_double(center.x()), CGAL::to_double(center.y()),
          CGAL::to_double(center.z())};
}

bool IsInSphere(const Vector3f& a, const Vector3f& b, const Vector3f& c,
                const Vector3f& d, const Vector3f& p) {
  return Perturbed::Instance().side_of_oriented_sphere(
             ToCgal(a), ToCgal(b), ToCgal(c), ToCgal(d), ToCgal(p),
             /*perturb=*/true) == CGAL::ON_POSITIVE_SIDE;
}

bool IsInCircle(const Vector3f& a, const Vector3f& b, const Vector3f& c,
                const Vector3f& p) {
  return Perturbed::Instance().coplanar_side_of_bounded_circle(
             ToCgal(a), ToCgal(b), ToCgal(c), ToCgal(p), /*perturb=*/true) ==
         CGAL::ON_BOUNDED_SIDE;
}

}  // namespace colmap_ext
