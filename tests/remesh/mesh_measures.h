#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// [F] degrees
inline std::vector<double> SmallestAngles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Facet& facet : mesh.facets) {
    double smallest = 180;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& at = mesh.vertices[facet[k]];
      const Eigen::Vector3f a = mesh.vertices[facet[(k + 1) % 3]] - at;
      const Eigen::Vector3f b = mesh.vertices[facet[(k + 2) % 3]] - at;
      smallest = std::min<double>(
          smallest, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI);
    }
    angles.push_back(smallest);
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
  for (const auto& [i, j, k] : mesh.facets) {
    const Eigen::Vector3f& a = mesh.vertices[i];
    const Eigen::Vector3f& b = mesh.vertices[j];
    const Eigen::Vector3f& c = mesh.vertices[k];
    for (const Eigen::Vector3f& point :
         {a, Eigen::Vector3f((a + b) / 2), Eigen::Vector3f((a + b + c) / 3)}) {
      distance = std::max(distance, bvh.Distance(point, 1e3));
    }
  }
  return distance;
}

}  // namespace colmap_ext
