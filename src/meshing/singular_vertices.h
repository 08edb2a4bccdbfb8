#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

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
  // Examines every vertex once.
  // \param is_free [C] labels of the cells, changed by Flip and UndoFlips
  SingularVertexTracker(const Tetrahedralization& tetrahedra,
                        std::vector<uint8_t>* is_free);

  // Examines none.
  // \param singular  all singular vertices, ascending
  SingularVertexTracker(const Tetrahedralization& tetrahedra,
                        std::vector<uint8_t>* is_free,
                        std::vector<uint32_t> singular);

  // The singular vertices, in ascending order. Examines the vertices of the
  // cells that have changed since the last call.
  const std::vector<uint32_t>& Singular();

  // Whether a vertex was not singular at the last call, and is at no cell that
  // has changed since. Safe from several threads.
  bool IsRegular(uint32_t vertex) const {
    return !is_touched_.contains(vertex) &&
           !std::binary_search(singular_.begin(), singular_.end(), vertex);
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
  std::vector<uint32_t>
      singular_;  // ascending; before the touched ones changed
  std::unordered_set<uint32_t> is_touched_;  // finite vertices of flipped cells
  std::vector<uint32_t> flips_;              // cells
  size_t num_examined_vertices_ = 0;
};

}  // namespace colmap_ext
