#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mesh/fan_split.h"
#include "tiles/cell_key.h"

namespace colmap_ext {

// A band's facets by the numbers of the whole mesh.
struct NumberedBand {
  std::vector<Facet> facets;           // the tile's own
  std::vector<uint32_t> own;           // [facets] which of the band's they are
  std::vector<uint32_t> new_vertices;  // of the band; numbered one by one
  std::vector<uint32_t> shared;        // numbers of vertices that other tiles'
                                       // facets have, too; ascending
};

// Numbers the vertices of a surface in the order in which facets use them, band
// by band. Bands agree on a vertex that they share by its first facet, the
// plan's vertices that it comes from, and its position.
class BandNumbers {
 public:
  // \param surface  of the next tile's band, split as the whole is at all
  //        facets of the tile's vertices; its sources are the plan's vertices
  // \param keys    [facets of the band] by the surface's facet sources
  // \param is_own  [facets of the band]
  NumberedBand Add(const FanSplit& surface, const std::vector<FacetKey>& keys,
                   const std::vector<uint8_t>& is_own);

  uint32_t NumVertices() const { return num_vertices_; }

 private:
  using Name = std::array<uint32_t, 8>;

  uint32_t num_vertices_ = 0;
  std::unordered_map<Name, uint32_t, KeyHash> shared_;
};

}  // namespace colmap_ext
