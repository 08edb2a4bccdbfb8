#pragma once

#include <cstdint>

#include "merging/cell_changes.h"
#include "merging/seam_labels.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// What the tiles have left with the labels of the seams, and as fixing has
// changed it.
class LabeledParts {
 public:
  // \pre all of these outlive it
  LabeledParts(const TileParts& parts, const SeamLabels& seam,
               const CellChanges& changes)
      : parts_(parts), seam_(seam), changes_(changes) {}

  // Labels are kMatter or kFreeSpace.
  TilePart Read(uint32_t tile) const {
    TilePart part = parts_.ReadPart(tile);
    ApplySeamLabels(seam_, part.tile, &part.labels);
    changes_.Apply(&part);
    return part;
  }

  // The tile of a vertex of the plan or of a centroid.
  uint32_t TileOf(uint32_t vertex) const { return changes_.TileOf(vertex); }

 private:
  const TileParts& parts_;
  const SeamLabels& seam_;
  const CellChanges& changes_;
};

}  // namespace colmap_ext
