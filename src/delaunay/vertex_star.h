#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The cells around a vertex, grouped into components: cells of one label that
// are connected through facets that contain the vertex.
struct VertexStar {
  struct Component {
    bool is_free = false;
    std::vector<uint32_t> cells;
  };

  std::vector<Component> components;  // ordered by their lowest cells

  // Lhuillier 2018, theorem 3, for a vertex on the boundary between free space
  // and matter: the surface around it is more than one fan. Within either there
  // is one component.
  bool IsSingular() const { return components.size() > 2; }
};

// \param is_free [cells] the cells' labels
void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star);

bool IsSingular(const Tetrahedralization& tetrahedra,
                const std::vector<uint8_t>& is_free, uint32_t vertex);

// All singular vertices, in ascending order.
std::vector<uint32_t> SingularVertices(const Tetrahedralization& tetrahedra,
                                       const std::vector<uint8_t>& is_free);

}  // namespace colmap_ext
