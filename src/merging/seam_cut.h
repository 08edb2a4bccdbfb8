#pragma once

#include "merging/seam_labels.h"
#include "scene/progress.h"

namespace colmap_ext {

// Cuts the cells whose labels their tiles could not determine, with the labels
// of all others fixed: tile by tile, each time with such cells of other tiles
// within twice seam_rings neighbors, which is as wide as a seam is. Each cut is
// minimal given the labels around it, so that the value of the cut of all cells
// never rises. With kAllAtOnce there is one cut: that of the whole plan, if it
// has the same labels of all other cells.
//
// \param seam_rings  TileCutOptions
// \return how many arcs the tiles on both sides tell differently; those have
// the
//         capacity that the tile of the cell where they begin tells
// \throw std::logic_error where a tile lacks a cell that another one has
size_t CutSeams(int seam_rings, SeamLabels* labels,
                const Progress& progress = {});

}  // namespace colmap_ext
