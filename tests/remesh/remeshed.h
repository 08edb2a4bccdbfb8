#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "mesh/surface.h"
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

// Starts with the lowest vertex.
inline Facet Turned(Facet facet) {
  std::rotate(facet.begin(), std::ranges::min_element(facet), facet.end());
  return facet;
}

// The facets all of whose corners come from fixed vertices, by these.
inline std::set<Facet> FixedFacets(const TriangleMesh& mesh,
                                   const std::vector<uint32_t>& sources) {
  std::set<Facet> facets;
  for (const Facet& facet : mesh.facets) {
    const Facet old = {sources[facet[0]], sources[facet[1]], sources[facet[2]]};
    if (std::ranges::find(old, kNone) == old.end()) {
      facets.insert(Turned(old));
    }
  }
  return facets;
}

// That fixed vertices, and the facets between them, are what they were.
// \param sources  [V] of the result: the vertex before, or kNone
inline void ExpectFixed(const TriangleMesh& before, const FixedVertices& fixed,
                        const TriangleMesh& after,
                        const std::vector<uint32_t>& sources) {
  ASSERT_EQ(sources.size(), after.vertices.size());
  std::set<uint32_t> found;
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i] != kNone) {
      EXPECT_TRUE(IsFixed(fixed, sources[i]));
      EXPECT_EQ(before.vertices[sources[i]], after.vertices[i]);
      EXPECT_TRUE(found.insert(sources[i]).second);
    }
  }
  EXPECT_EQ(static_cast<size_t>(std::ranges::count(fixed, 1)), found.size());
  const std::set<Facet> facets = FixedFacets(after, sources);
  for (const Facet& facet : before.facets) {
    if (IsFixed(fixed, facet)) {
      EXPECT_TRUE(facets.contains(Turned(facet)));
    }
  }
}

}  // namespace colmap_ext
