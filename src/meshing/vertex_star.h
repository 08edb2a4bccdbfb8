#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// Labels of cells, with some of them flipped: without a change of the labels,
// which other threads may read.
class CellLabels {
 public:
  // \param is_free [C] 1: free space, 0: matter
  // \param flipped cells, ascending
  // Both have to live on.
  explicit CellLabels(const std::vector<uint8_t>& is_free,
                      std::span<const uint32_t> flipped = {});

  uint8_t operator[](uint32_t cell) const {
    const bool may_be_flipped = ((residues_ >> (cell % 64)) & 1) != 0;
    return is_free_[cell] ^
           static_cast<uint8_t>(may_be_flipped && IsFlipped(cell));
  }

 private:
  bool IsFlipped(uint32_t cell) const;

  const std::vector<uint8_t>& is_free_;
  std::span<const uint32_t> flipped_;
  uint64_t residues_ = 0;  // bit i: a cell that is i modulo 64 is flipped
};

// The cells around a vertex, grouped into K components: cells of one label that
// are connected through facets that contain the vertex. Components are ordered
// by their lowest cells.
struct VertexStar {
  std::vector<uint32_t> cells;     // component after component
  std::vector<size_t> offsets{0};  // [K + 1], into cells
  std::vector<uint8_t> is_free;    // [K], 1: free space, 0: matter

  size_t NumComponents() const { return is_free.size(); }

  // The cells of a component, the lowest one first.
  std::span<const uint32_t> Component(size_t component) const {
    return {cells.data() + offsets[component],
            cells.data() + offsets[component + 1]};
  }

  // Whether the surface around the vertex is more than one fan [Lhuillier2018,
  // theorem 3]. Around a vertex of the surface there are two components then,
  // around one within free space or within matter there is one.
  bool IsSingular() const { return NumComponents() > 2; }
};

// The cells around a vertex as a graph, whatever their labels are.
struct StarGraph {
  std::vector<uint32_t> cells;  // [S], as IncidentCells() has them
  // [S], places in cells: across the facets that contain the vertex.
  std::vector<std::array<uint32_t, 3>> neighbors;
};

// \param graph is overwritten
void MakeStarGraph(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   StarGraph* graph);

// \param star is overwritten
void MakeVertexStar(const StarGraph& graph, const CellLabels& labels,
                    VertexStar* star);
void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star);

// VertexStar::NumComponents for some labels. Much faster than to make the star.
size_t CountComponents(const StarGraph& graph, const CellLabels& labels);

}  // namespace colmap_ext
