#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "delaunay/cell_places.h"
#include "merging/seam_labels.h"
#include "meshing/cell_splitting.h"
#include "tiles/cell_key.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// The cells of one tile, read in blocks on demand.
class TileWindow {
 public:
  TileWindow(const TileParts& parts, const SeamLabels& seam, uint32_t tile);

  // The cells around one of the tile's own vertices.
  // \param vertex  of the tile
  void CellsAt(uint32_t vertex, std::vector<uint32_t>* cells);

  // The plan's vertices at the corners of a cell.
  CellKey CornersOf(uint32_t cell);

  // With that of the seams.
  // \pre a star cell
  uint8_t LabelOf(uint32_t cell);

  CellCapacities CapacitiesOf(uint32_t cell);

 private:
  // 29 kB. A choice: some stars.
  static constexpr uint32_t kBlockCells = 512;

  const PartCells& BlockOf(uint32_t cell);

  const TileParts& parts_;
  const SeamLabels& seam_;
  const uint32_t tile_;
  const PartVertices vertices_;
  const uint32_t num_cells_;
  std::vector<std::unique_ptr<PartCells>> blocks_;  // or nothing
  CellPlaces places_;
};

}  // namespace colmap_ext
