#pragma once

#include <cstdint>
#include <set>

#include "mesh/triangle_mesh.h"
#include "tests/random.h"

namespace colmap_ext {

// Facets between random ones of few vertices, at random positions: edges and
// vertices of all kinds. No facet repeats a vertex.
// \param allow_duplicates of facets
inline TriangleMesh RandomSoup(uint32_t num_vertices, uint32_t num_facets,
                               bool allow_duplicates, Random* random) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_vertices; ++i) {
    mesh.vertices.emplace_back(random->Unit(), random->Unit(), random->Unit());
  }
  std::set<std::set<uint32_t>> triples;
  for (uint32_t i = 0; i < num_facets; ++i) {
    const Facet facet = {random->Below(num_vertices),
                         random->Below(num_vertices),
                         random->Below(num_vertices)};
    const std::set<uint32_t> triple(facet.begin(), facet.end());
    if (triple.size() == 3 &&
        (triples.insert(triple).second || allow_duplicates)) {
      mesh.facets.push_back(facet);
    }
  }
  return mesh;
}

}  // namespace colmap_ext
