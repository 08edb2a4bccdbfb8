#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/topology.h"

namespace colmap_ext {

// The facets around a vertex, as arcs from their second to their third corner.
struct Link {
  std::map<uint32_t, uint32_t> next;
  std::map<uint32_t, uint32_t> previous;

  // \return false where another arc starts or ends where this one does
  bool Add(uint32_t from, uint32_t to) {
    return next.emplace(from, to).second && previous.emplace(to, from).second;
  }

  bool IsOneCycleOrPath() const {
    if (next.empty()) {
      return false;
    }
    // Where a path starts, or anywhere on a cycle.
    uint32_t start = next.begin()->first;
    for (const auto& [from, to] : next) {
      start = previous.contains(from) ? start : from;
    }
    size_t length = 0;
    uint32_t at = start;
    while (next.contains(at)) {
      at = next.at(at);
      ++length;
      if (at == start) {
        return length == next.size() && length >= 3;
      }
    }
    return length == next.size();
  }
};

// An independent definition: indices are in range, all vertices are finite and
// used, and the facets around every vertex, taken as arcs from their second to
// their third corner, form one simple cycle of at least three arcs or one
// simple path.
inline bool HasManifoldLinks(const TriangleMesh& mesh) {
  std::vector<Link> links(mesh.vertices.size());
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      if (facet[k] >= mesh.vertices.size() || facet[k] == facet[(k + 1) % 3]) {
        return false;
      }
    }
    for (int k = 0; k < 3; ++k) {
      if (!links[facet[k]].Add(facet[(k + 1) % 3], facet[(k + 2) % 3])) {
        return false;
      }
    }
  }
  return std::ranges::all_of(links, &Link::IsOneCycleOrPath) &&
         std::ranges::all_of(mesh.vertices,
                             [](const auto& p) { return p.allFinite(); });
}

// That a mesh is manifold, by Analyze() and by its links.
inline MeshReport ExpectManifoldMesh(const TriangleMesh& mesh) {
  const MeshReport report = Analyze(mesh);
  EXPECT_TRUE(report.IsManifold());
  EXPECT_EQ(report.Defects(), "");
  EXPECT_TRUE(HasManifoldLinks(mesh));
  return report;
}

// That the result is manifold, and has the topology of the mesh.
inline void ExpectSameTopology(const TriangleMesh& mesh,
                               const TriangleMesh& result) {
  const MeshReport before = Analyze(mesh);
  const MeshReport after = ExpectManifoldMesh(result);
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(after.num_components, before.num_components);
  EXPECT_EQ(after.num_border_loops, before.num_border_loops);
}

}  // namespace colmap_ext
