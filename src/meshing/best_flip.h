#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// What the flip of some cells, free space to matter and matter to free space,
// changes. The lower change is the better one: the excess counts first.
struct FlipChange {
  int64_t excess = 0;  // components beyond the second, summed over the vertices
  int64_t energy = 0;  // value of the cut, capacities' unit

  // NOLINTNEXTLINE(modernize-use-nullptr)
  auto operator<=>(const FlipChange&) const = default;
};

// Whether a vertex is known not to be singular.
using IsRegular = std::function<bool(uint32_t)>;

// The cells whose flip makes a singular vertex less singular: with the lowest
// change among
//   - the cells of one component of the vertex's star,
//   - those of all components of one label but one, and then those of all
//     components of the other label but one, as these are after the first flip.
// Of equal changes the first one found is taken.
//
// Reads labels of cells that have a vertex in common with the vertex's cells.
//
// \param max_excess of the change
// \param is_free    [C] labels of the cells
// \param is_regular saves looking at the stars of these vertices
// \return ascending; empty where the vertex is not singular or all changes
//         exceed max_excess
std::vector<uint32_t> BestFlip(const Tetrahedralization& tetrahedra,
                               const FlowCapacities& graph, uint32_t vertex,
                               int64_t max_excess,
                               const std::vector<uint8_t>& is_free,
                               const IsRegular& is_regular);

}  // namespace colmap_ext
