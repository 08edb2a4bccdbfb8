#include "meshing/fix_singular_vertices.h"

#include <tbb/parallel_for.h>

#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

// Facets on the surface as arcs, 4 * cell + facet of the cell in matter, in
// ascending order.
std::vector<uint32_t> SurfaceArcs(const Tetrahedralization& tetrahedra,
                                  const std::vector<uint8_t>& is_free) {
  const auto append = [&](size_t cell_index, std::vector<uint32_t>* arcs) {
    const auto index = static_cast<uint32_t>(cell_index);
    const auto& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4 && !is_free[index]; ++i) {
      const bool is_finite =
          !tetrahedra.IsInfinite(index) || cell.vertices[i] == kInfiniteVertex;
      if (is_finite && is_free[cell.neighbors[i]]) {
        arcs->push_back(4 * index + i);
      }
    }
  };
  return MakeRows<uint32_t>(tetrahedra.cells.size(), append).values;
}

// Turns through matter around the edge of a surface facet that lies opposite to
// the corner `away`, up to the next surface facet.
// \return its arc
uint32_t TurnThroughMatter(const Tetrahedralization& tetrahedra,
                           const std::vector<uint8_t>& is_free, uint32_t arc,
                           uint32_t away) {
  uint32_t cell = arc / 4;
  int entry = static_cast<int>(arc % 4);
  int exit = tetrahedra.IndexOf(cell, away);
  for (;;) {
    const uint32_t next = tetrahedra.cells[cell].neighbors[exit];
    if (is_free[next]) {
      return 4 * cell + exit;
    }
    // The facet of the next cell that also has the edge: opposite to the corner
    // that the facet just crossed shares with the one behind it.
    const uint32_t pivot = tetrahedra.cells[cell].vertices[entry];
    entry = tetrahedra.FacetTo(next, cell);
    exit = tetrahedra.IndexOf(next, pivot);
    cell = next;
  }
}

}  // namespace

ExtractedSurface ExtractSurface(const Tetrahedralization& tetrahedra,
                                const std::vector<uint8_t>& is_free) {
  const std::vector<uint32_t> arcs = SurfaceArcs(tetrahedra, is_free);
  ExtractedSurface surface;
  surface.mesh.vertices = tetrahedra.points;
  surface.mesh.facets.reserve(arcs.size());
  for (const uint32_t arc : arcs) {
    const auto& vertices = tetrahedra.cells[arc / 4].vertices;
    const auto& inward = kFacetCorners[arc % 4];
    surface.mesh.facets.push_back(
        {vertices[inward[0]], vertices[inward[2]], vertices[inward[1]]});
  }
  const std::vector<Facet>& facets = surface.mesh.facets;
  surface.partners.assign(3 * facets.size(), kNone);
  tbb::parallel_for(size_t{0}, facets.size(), [&](size_t facet) {
    for (uint32_t k = 0; k < 3; ++k) {
      const auto half = static_cast<uint32_t>(3 * facet + k);
      const uint32_t away = facets[facet][(k + 2) % 3];
      const uint32_t arc =
          TurnThroughMatter(tetrahedra, is_free, arcs[facet], away);
      const uint32_t other = IndexOf(arcs, arc);
      if (other == kNone) {
        continue;  // the facet goes to infinity
      }
      uint32_t partner = 3 * other;
      while (FromVertex(facets, partner) != ToVertex(facets, half)) {
        ++partner;
      }
      surface.partners[half] = partner;
    }
  });
  return surface;
}

}  // namespace colmap_ext
