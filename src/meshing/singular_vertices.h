#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_set>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

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

// All singular vertices (VertexStar::IsSingular), in ascending order. Examines
// every vertex, in parallel.
// \param is_free [C] labels of the cells, 1: free space, 0: matter
std::vector<uint32_t> SingularVertices(const Tetrahedralization& tetrahedra,
                                       const std::vector<uint8_t>& is_free);

// Keeps the singular vertices up to date while labels change. Each change costs
// as much as the stars of the vertices of the cells that change, whatever the
// size of the tetrahedralization.
//
// Cells may be split between calls: the children of a cell have its label, so
// that the splitting makes no vertex singular and none regular.
class SingularVertexTracker {
 public:
  // \param is_free [C] labels of the cells, changed by Flip and UndoFlips
  // \param singular  all singular vertices, ascending; nullptr: every vertex is
  //        examined once
  SingularVertexTracker(const Tetrahedralization& tetrahedra,
                        std::vector<uint8_t>* is_free,
                        const std::vector<uint32_t>* singular = nullptr);

  // The singular vertices, in ascending order. Examines the vertices of the
  // cells that have changed since the last call.
  const std::vector<uint32_t>& Singular();

  // Whether a vertex was not singular at the last call, and is at no cell that
  // has changed since. Safe from several threads.
  bool IsRegular(uint32_t vertex) const {
    return !is_touched_.contains(vertex) &&
           !std::ranges::binary_search(singular_, vertex);
  }

  // Swaps free space and matter in some cells.
  void Flip(std::span<const uint32_t> cells);

  // The flips of single cells since the start that have not been undone.
  size_t num_flips() const { return flips_.size(); }

  // Takes back all flips but the first num_flips.
  // \pre num_flips <= num_flips(), and no cell was split after those flips
  void UndoFlips(size_t num_flips);

  // How often the surroundings of a vertex were examined.
  size_t num_examined_vertices() const { return num_examined_vertices_; }

 private:
  void FlipCell(uint32_t cell);

  const Tetrahedralization& tetrahedra_;
  std::vector<uint8_t>* is_free_;
  // Ascending; before the touched ones changed.
  std::vector<uint32_t> singular_;
  std::unordered_set<uint32_t> is_touched_;  // finite vertices of flipped cells
  std::vector<uint32_t> flips_;              // cells
  size_t num_examined_vertices_;
};

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
