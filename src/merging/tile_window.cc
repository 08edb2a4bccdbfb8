#include "merging/tile_window.h"

#include <algorithm>

namespace colmap_ext {

TileWindow::TileWindow(const TileParts& parts, const SeamLabels& seam,
                       uint32_t tile)
    : parts_(parts),
      seam_(seam),
      tile_(tile),
      vertices_(parts.ReadVertices(tile)),
      num_cells_(parts.NumCells(tile)),
      blocks_((num_cells_ + kBlockCells - 1) / kBlockCells) {}

const PartCells& TileWindow::BlockOf(uint32_t cell) {
  std::unique_ptr<PartCells>& block = blocks_[cell / kBlockCells];
  if (!block) {
    const uint32_t begin = cell - cell % kBlockCells;
    block = std::make_unique<PartCells>(parts_.ReadCells(
        tile_, begin, std::min(num_cells_, begin + kBlockCells)));
  }
  return *block;
}

void TileWindow::CellsAt(uint32_t vertex, std::vector<uint32_t>* cells) {
  places_.Clear();
  cells->clear();
  places_.PlaceIn(vertices_.first_cells[vertex], cells);
  for (size_t i = 0; i < cells->size(); ++i) {
    const uint32_t index = (*cells)[i];
    const auto& cell = BlockOf(index).cells[index % kBlockCells];
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        places_.PlaceIn(cell.neighbors[k], cells);
      }
    }
  }
}

CellKey TileWindow::CornersOf(uint32_t cell) {
  CellKey corners = BlockOf(cell).cells[cell % kBlockCells].vertices;
  for (uint32_t& corner : corners) {
    corner = corner == kInfiniteVertex ? corner : vertices_.ids[corner];
  }
  return corners;
}

uint8_t TileWindow::LabelOf(uint32_t cell) {
  const uint8_t label = BlockOf(cell).labels[cell % kBlockCells];
  return label == kNotKnown ? seam_.At(CornersOf(cell)) : label;
}

CellCapacities TileWindow::CapacitiesOf(uint32_t cell) {
  const FlowCapacities& graph = BlockOf(cell).graph;
  const uint32_t place = cell % kBlockCells;
  return {graph.capacities[place], graph.source[place], graph.sink[place]};
}

}  // namespace colmap_ext
