#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "tiles/merged_plan.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_cut.h"

namespace colmap_ext {

// The cells of one tile, read in blocks on demand.
class TileWindow {
 public:
  TileWindow(const SeamLabels& seam, uint32_t tile);

  // The cells around one of the tile's own vertices.
  // \param vertex  of the tile
  void CellsAt(uint32_t vertex, std::vector<uint32_t>* cells);

  // The plan's vertices at the corners of a cell.
  CellKey CornersOf(uint32_t cell) {
    return IdsOf(BlockOf(cell).cells[cell % kBlockCells].vertices,
                 vertices_.ids);
  }

  // With that of the seams.
  // \pre a star cell
  uint8_t LabelOf(uint32_t cell);

  NodeCapacities CapacitiesOf(uint32_t cell) {
    return BlockOf(cell).graph[cell % kBlockCells];
  }

 private:
  // 29 kB. A choice: some stars.
  static constexpr uint32_t kBlockCells = 512;

  const PartCells& BlockOf(uint32_t cell);

  const SeamLabels& seam_;
  const uint32_t tile_;
  const PartVertices vertices_;
  const uint32_t num_cells_;
  std::vector<std::unique_ptr<PartCells>> blocks_;  // or nothing
};

// A cell of a patch by the plan's vertices, oriented.
struct PatchCell {
  CellKey corners;
  uint8_t label = 0;
  bool has_capacities = false;  // which its own tile knows
  NodeCapacities capacities = {};
};

// Flips at a vertex concern its own cells, and are judged by the cells of their
// vertices.
inline constexpr uint8_t kNumRings = 2;

// Collects cells around vertices from all tiles.
class PatchCollector {
 public:
  explicit PatchCollector(const SeamLabels& seam)
      : blocks_(seam.plan().Blocks()), seam_(seam) {}

  // All cells in kNumRings rings around the vertices that have not been taken
  // before, the first two corners the lowest, in the order of their corners.
  // Reads what it needs of the tiles.
  std::vector<PatchCell> Take(const std::vector<uint32_t>& vertices);

 private:
  void AddRingsIn(uint32_t tile, std::vector<uint32_t> ids);
  void Reach(uint32_t id, uint8_t ring, std::vector<uint32_t>* here,
             uint32_t tile);
  void AddCell(uint32_t tile, uint32_t index, TileWindow* from);
  void AddMissingCapacities();

  const PlanBlocks& blocks_;
  const SeamLabels& seam_;
  std::vector<CellKey> keys_;  // of all cells so far
  PlaceTable<CellKey, KeyHash> places_;
  size_t num_taken_ = 0;
  std::vector<PatchCell> cells_;  // of the others
  // How many rings each vertex is off those that were asked for.
  std::unordered_map<uint32_t, uint8_t> rings_;
  std::map<uint32_t, std::vector<uint32_t>> waiting_;  // vertices by tile
};

}  // namespace colmap_ext
