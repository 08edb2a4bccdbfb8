#include "spatial/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

// On which side of the plane through a, b and c a point d lies: 1, -1, or 0
// where rounding leaves it open. The bound on the error is (7 + 56 e) e with
// e = 2^-53 [Shewchuk1997, bound A of orient3d]; here it is 16 e.
int Side(const Vector3d& a, const Vector3d& b, const Vector3d& c,
         const Vector3d& d) {
  constexpr double kError = 8 * std::numeric_limits<double>::epsilon();
  const Vector3d u = a - d;
  const Vector3d v = b - d;
  const Vector3d w = c - d;
  const double vw_x = v.y() * w.z(), wv_x = v.z() * w.y();
  const double vw_y = v.z() * w.x(), wv_y = v.x() * w.z();
  const double vw_z = v.x() * w.y(), wv_z = v.y() * w.x();
  const double determinant =
      u.x() * (vw_x - wv_x) + u.y() * (vw_y - wv_y) + u.z() * (vw_z - wv_z);
  const double bound =
      kError * (std::abs(u.x()) * (std::abs(vw_x) + std::abs(wv_x)) +
                std::abs(u.y()) * (std::abs(vw_y) + std::abs(wv_y)) +
                std::abs(u.z()) * (std::abs(vw_z) + std::abs(wv_z)));
  return determinant > bound ? 1 : determinant < -bound ? -1 : 0;
}

// Whether a segment whose ends lie on both sides of a facet's plane passes
// through the facet or its border.
bool PassesThrough(const Vector3d& p, const Vector3d& q, const Corners& facet) {
  const int ab = Side(p, q, facet[0], facet[1]);
  const int bc = Side(p, q, facet[1], facet[2]);
  const int ca = Side(p, q, facet[2], facet[0]);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

// Whether an edge of the first facet passes through the second.
// \param shared  the corner of the first that is a corner of the second too,
//        or -1
bool Pierces(const Corners& first, const Corners& second, int shared) {
  std::array<int, 3> sides{};
  for (int k = 0; k < 3; ++k) {
    sides[k] =
        k == shared ? 0 : Side(second[0], second[1], second[2], first[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (sides[k] * sides[next] < 0 &&
        PassesThrough(first[k], first[next], second)) {
      return true;
    }
  }
  return false;
}

// The corner of a facet that another one has too: -1 if there is none, 3 if
// there are several.
int SharedCorner(const Facet& facet, const Facet& other) {
  int shared = -1;
  for (int k = 0; k < 3; ++k) {
    if (std::find(other.begin(), other.end(), facet[k]) != other.end()) {
      shared = shared < 0 ? k : 3;
    }
  }
  return shared;
}

Corners CornersOf(const TriangleMesh& mesh, const Facet& facet) {
  return {mesh.vertices[facet[0]].cast<double>(),
          mesh.vertices[facet[1]].cast<double>(),
          mesh.vertices[facet[2]].cast<double>()};
}

bool Intersect(const TriangleMesh& mesh, const Facet& first,
               const Facet& second) {
  const int shared = SharedCorner(first, second);
  if (shared == 3) {
    return false;
  }
  const Corners a = CornersOf(mesh, first);
  const Corners b = CornersOf(mesh, second);
  return Pierces(a, b, shared) || Pierces(b, a, SharedCorner(second, first));
}

}  // namespace

std::vector<std::array<uint32_t, 2>> FindSelfIntersections(
    const TriangleMesh& mesh) {
  using Pairs = std::vector<std::array<uint32_t, 2>>;
  const FacetTree tree(mesh);
  tbb::enumerable_thread_specific<Pairs> found;
  tbb::parallel_for(size_t{0}, tree.NumLeaves(), [&](size_t leaf) {
    tree.ForEachPair(leaf, [&](uint32_t a, uint32_t b) {
      if (Intersect(mesh, mesh.facets[a], mesh.facets[b])) {
        found.local().push_back({std::min(a, b), std::max(a, b)});
      }
    });
  });
  Pairs pairs;
  for (const Pairs& part : found) {
    pairs.insert(pairs.end(), part.begin(), part.end());
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace colmap_ext
