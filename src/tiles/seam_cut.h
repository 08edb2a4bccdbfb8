#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tiles/cell_key.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// Labels of the cells that their tiles could not tell, and of those that are
// shared.
struct SeamLabels {
  // \param corners  in any order
  // \throw std::logic_error where there is none
  uint8_t At(const CellKey& corners) const;

  std::unordered_map<CellKey, uint8_t, KeyHash> labels;
  size_t num_cut_cells = 0;  // that the tiles could not tell
  int64_t flow = 0;          // through them
};

// Cuts the cells that the tiles could not tell, with the labels of all others
// fixed: as the minimum cut of the whole plan does where it has the same labels
// of those. The result depends on what the tiles left alone, not on their
// order. \param seams [tiles] of all tiles of the plan \throw std::logic_error
// where the tiles contradict each other
SeamLabels CutSeams(const std::vector<TileSeam>& seams);

// Gives labels to all star cells; what is no star cell is matter.
// \param labels [cells] TilePart::labels
// \throw std::logic_error where a label is missing
void ApplySeamLabels(const SeamLabels& seam, const TileTetrahedra& tile,
                     std::vector<uint8_t>* labels);

}  // namespace colmap_ext
