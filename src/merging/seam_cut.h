#pragma once

#include "merging/seam_labels.h"
#include "scene/progress.h"

namespace colmap_ext {

// Cuts the cells that their tiles could not tell, with the labels of all others
// fixed: tile by tile, each time with those of other tiles within twice
// seam_rings neighbors, which is as wide as a seam is. Each of these cuts is
// the least with the labels around it as they are, so that the value of the cut
// of all cells never rises. With kAllAtOnce there is one cut: that of the whole
// plan, where it has the same labels of all other cells.
//
// \param seam_rings  TileCutOptions
// \return how many arcs the tiles on both sides tell differently; those have
// the
//         capacity that the tile of the cell where they begin tells
// \throw std::logic_error where a tile lacks a cell that another one has
size_t CutSeams(int seam_rings, SeamLabels* labels,
                const Progress& progress = {});

}  // namespace colmap_ext
