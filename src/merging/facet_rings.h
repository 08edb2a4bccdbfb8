#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "merging/sectioned_mesh.h"

namespace colmap_ext {

// Some facets of a mesh, each with its number, in any order.
struct FacetList {
  std::vector<std::pair<uint32_t, Facet>> facets;

  void Add(uint32_t number, const Facet& facet) {
    facets.emplace_back(number, facet);
  }

  // Each of them once.
  MeshPart Gather(const SectionedMesh& mesh);
};

// All facets at the vertices within some rings of edges around some facets,
// whichever sections they are of. Takes memory for these, and for one section's
// facets at a time.
// \param facets  numbers
FacetList FacetsAround(const SectionedMesh& mesh,
                       const std::vector<uint32_t>& facets, uint8_t num_rings);

}  // namespace colmap_ext
