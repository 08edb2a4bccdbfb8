#include "tiles/conflict_zone.h"

#include <cmath>

#include <Eigen/Geometry>

#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

// The centre of the sphere through o, a, b, c relative to o (docs/method.md,
// section 2.2).
Eigen::Vector3d CenterOfSphere(const Eigen::Vector3f& o,
                               const Eigen::Vector3f& pa,
                               const Eigen::Vector3f& pb,
                               const Eigen::Vector3f& pc) {
  // The volume over the product of the edges' lengths. The centre of a flatter
  // cell is far off in double precision.
  constexpr double kMinFlatness = 1e-5;
  const Eigen::Vector3d a = pa.cast<double>() - o.cast<double>();
  const Eigen::Vector3d b = pb.cast<double>() - o.cast<double>();
  const Eigen::Vector3d c = pc.cast<double>() - o.cast<double>();
  const Eigen::Vector3d bc = b.cross(c);
  const double volume = a.dot(bc);
  if (!(std::abs(volume) > kMinFlatness * a.norm() * b.norm() * c.norm())) {
    return CenterFrom(o, pa, pb, pc);
  }
  return (a.squaredNorm() * bc + b.squaredNorm() * c.cross(a) +
          c.squaredNorm() * a.cross(b)) /
         (2 * volume);
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
    const Eigen::Vector3d offset =
        CenterOfSphere(corner(0), corner(1), corner(2), corner(3));
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
