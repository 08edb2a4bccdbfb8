#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/normals.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// [F] degrees
inline std::vector<double> SmallestAngles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Facet& facet : mesh.facets) {
    angles.push_back(std::min({AngleVector(mesh, facet, 0).norm(),
                               AngleVector(mesh, facet, 1).norm(),
                               AngleVector(mesh, facet, 2).norm()}) *
                     180 / M_PI);
  }
  return angles;
}

inline double Percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * (values.size() - 1))];
}

// The largest distance of the corners, middles of edges and centres of one
// mesh's facets from another.
inline double Distance(const TriangleMesh& mesh, const TriangleMesh& other) {
  const Bvh bvh(other);
  double distance = 0;
  for (const Facet& facet : mesh.facets) {
    const auto [a, b, c] = CornersOf(mesh, facet);
    for (const Eigen::Vector3f& point :
         {a, Eigen::Vector3f((a + b) / 2), Eigen::Vector3f((a + b + c) / 3)}) {
      distance = std::max(distance, bvh.Distance(point, 1e3));
    }
  }
  return distance;
}

}  // namespace colmap_ext
