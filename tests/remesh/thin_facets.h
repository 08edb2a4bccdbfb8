#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "mesh/normals.h"
#include "mesh/triangle_mesh.h"
#include "tests/random.h"

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

inline double ShareBelow(double angle, const TriangleMesh& mesh) {
  const std::vector<double> angles = SmallestAngles(mesh);
  const auto count = std::ranges::count_if(
      angles, [&](double smallest) { return smallest < angle; });
  return static_cast<double>(count) / static_cast<double>(angles.size());
}

// Moves some vertices along an edge, nearly up to its other end: needles and
// caps.
inline TriangleMesh MakeThinFacets(TriangleMesh mesh, Random* random) {
  std::set<uint32_t> used;
  for (const auto& [a, b, c] : mesh.facets) {
    if (random->Chance(0.02) && used.insert(a).second &&
        used.insert(b).second && used.insert(c).second) {
      mesh.vertices[a] = 0.1F * mesh.vertices[a] + 0.9F * mesh.vertices[b];
    }
  }
  return mesh;
}

}  // namespace colmap_ext
