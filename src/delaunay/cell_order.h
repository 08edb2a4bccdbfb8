#pragma once

#include <vector>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// Sorts a cell's corners, and its neighbors along with them, so that the first
// two vertices are the lowest and the cell keeps its orientation.
void SortCorners(Tetrahedralization::Cell* cell);

// Puts the cells into an order that depends on their vertices alone.
// \pre the corners of each cell are sorted
void SortCells(std::vector<Tetrahedralization::Cell>* cells);

}  // namespace colmap_ext
