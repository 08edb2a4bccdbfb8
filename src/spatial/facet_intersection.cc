#include "spatial/facet_intersection.h"

#include <algorithm>
#include <array>

#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;
using Sides = std::array<int, 3>;  // of each corner, see Orientation()

Corners CornersOf(const std::vector<Eigen::Vector3f>& vertices,
                  const Facet& facet) {
  return {vertices[facet[0]].cast<double>(), vertices[facet[1]].cast<double>(),
          vertices[facet[2]].cast<double>()};
}

// Whether two segments in a plane meet, seen against an axis.
// \pre the axis does not lie in the plane
bool SegmentsMeet(const Vector3d& p, const Vector3d& q, const Vector3d& a,
                  const Vector3d& b, int axis) {
  const int pq_a = Turn(p, q, a, axis), pq_b = Turn(p, q, b, axis);
  const int ab_p = Turn(a, b, p, axis), ab_q = Turn(a, b, q, axis);
  if (pq_a * pq_b > 0 || ab_p * ab_q > 0) {
    return false;
  }
  if (pq_a == 0 && pq_b == 0 && ab_p == 0 && ab_q == 0) {  // on one line
    return (p.cwiseMin(q).array() <= a.cwiseMax(b).array()).all() &&
           (a.cwiseMin(b).array() <= p.cwiseMax(q).array()).all();
  }
  return true;
}

// Whether a segment in the plane of a facet meets it.
bool MeetsInPlane(const Vector3d& p, const Vector3d& q, const Corners& facet) {
  for (int axis = 0; axis < 3; ++axis) {
    const int turn = Turn(facet[0], facet[1], facet[2], axis);
    if (turn == 0) {
      continue;
    }
    bool is_inside = true;
    for (int k = 0; k < 3; ++k) {
      const Vector3d& a = facet[k];
      const Vector3d& b = facet[(k + 1) % 3];
      is_inside = is_inside && turn * Turn(a, b, p, axis) >= 0;
      if (SegmentsMeet(p, q, a, b, axis)) {
        return true;
      }
    }
    return is_inside;
  }
  return false;
}

// Whether a segment that is not in a facet's plane meets the facet.
// \pre it meets the plane
bool PassesThrough(const Vector3d& p, const Vector3d& q, const Corners& facet) {
  const int ab = Orientation(p, q, facet[0], facet[1]);
  const int bc = Orientation(p, q, facet[1], facet[2]);
  if (ab * bc < 0) {
    return false;
  }
  const int ca = Orientation(p, q, facet[2], facet[0]);
  return ab * ca >= 0 && bc * ca >= 0;
}

// \param p_side, q_side  on which side of the facet's plane the ends lie
bool SegmentMeets(const Vector3d& p, int p_side, const Vector3d& q, int q_side,
                  const Corners& facet) {
  if (p_side * q_side > 0) {
    return false;
  }
  return p_side == 0 && q_side == 0 ? MeetsInPlane(p, q, facet)
                                    : PassesThrough(p, q, facet);
}

Sides SidesOf(const Corners& corners, const Corners& plane) {
  Sides sides{};
  for (int k = 0; k < 3; ++k) {
    sides[k] = Orientation(plane[0], plane[1], plane[2], corners[k]);
  }
  return sides;
}

bool AreOnOneSide(const Sides& sides) {
  return sides[0] != 0 && sides[0] == sides[1] && sides[0] == sides[2];
}

bool AnyEdgeMeets(const Corners& corners, const Sides& sides,
                  const Corners& facet) {
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (SegmentMeets(corners[k], sides[k], corners[next], sides[next], facet)) {
      return true;
    }
  }
  return false;
}

bool Meet(const Corners& a, const Corners& b) {
  const Sides a_sides = SidesOf(a, b);
  if (AreOnOneSide(a_sides)) {
    return false;
  }
  const Sides b_sides = SidesOf(b, a);
  return !AreOnOneSide(b_sides) &&
         (AnyEdgeMeets(a, a_sides, b) || AnyEdgeMeets(b, b_sides, a));
}

// Whether a facet but for its corner k lies on one side of another's plane.
bool LiesAside(const Corners& corners, int k, const Corners& plane) {
  return Orientation(plane[0], plane[1], plane[2], corners[(k + 1) % 3]) *
             Orientation(plane[0], plane[1], plane[2], corners[(k + 2) % 3]) >
         0;
}

// Whether the side opposite of corner k meets a facet.
bool OppositeSideMeets(const Corners& corners, int k, const Corners& facet) {
  const Vector3d& p = corners[(k + 1) % 3];
  const Vector3d& q = corners[(k + 2) % 3];
  const int p_side = Orientation(facet[0], facet[1], facet[2], p);
  const int q_side = Orientation(facet[0], facet[1], facet[2], q);
  return SegmentMeets(p, p_side, q, q_side, facet);
}

// Whether p and q lie in one plane with the edge from a to b, and on one side
// of it.
bool IsFolded(const Vector3d& a, const Vector3d& b, const Vector3d& p,
              const Vector3d& q) {
  if (Orientation(a, b, p, q) != 0) {
    return false;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (Turn(a, b, p, axis) != 0) {
      return Turn(a, b, p, axis) == Turn(a, b, q, axis);
    }
  }
  return false;
}

// The corners of a facet that are corners of another one too, and those that
// are not.
struct CommonCorners {
  int num_common = 0;
  int common = 0;  // the last one
  int other = 0;   // the last one
};

CommonCorners FindCommon(const Facet& facet, const Facet& other) {
  CommonCorners found;
  for (int k = 0; k < 3; ++k) {
    if (std::find(other.begin(), other.end(), facet[k]) != other.end()) {
      ++found.num_common;
      found.common = k;
    } else {
      found.other = k;
    }
  }
  return found;
}

bool MeetBeyondCommon(const Corners& a, const Corners& b, const Facet& first,
                      const Facet& second) {
  const CommonCorners in_first = FindCommon(first, second);
  if (in_first.num_common == 0) {
    return Meet(a, b);
  }
  // Most facets with one common corner end here.
  if (in_first.num_common == 1 && LiesAside(a, in_first.common, b)) {
    return false;
  }
  const CommonCorners in_second = FindCommon(second, first);
  if (in_first.num_common == 1) {
    return OppositeSideMeets(a, in_first.common, b) ||
           OppositeSideMeets(b, in_second.common, a);
  }
  return in_first.num_common == 3 ||
         IsFolded(a[(in_first.other + 1) % 3], a[(in_first.other + 2) % 3],
                  a[in_first.other], b[in_second.other]);
}

}  // namespace

bool FacetsIntersect(const std::vector<Eigen::Vector3f>& vertices,
                     const Facet& first, const Facet& second) {
  const Corners a = CornersOf(vertices, first);
  const Corners b = CornersOf(vertices, second);
  const auto has_area = [&](const Facet& facet) {
    return !AreCollinear(vertices[facet[0]], vertices[facet[1]],
                         vertices[facet[2]]);
  };
  return MeetBeyondCommon(a, b, first, second) && has_area(first) &&
         has_area(second);
}

}  // namespace colmap_ext
