#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "merging/seam_labels.h"
#include "merging/tile_window.h"
#include "meshing/cell_splitting.h"
#include "tiles/cell_key.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// A cell of a patch by the plan's vertices, oriented.
struct PatchCell {
  CellKey corners;
  uint8_t label = 0;
  bool has_capacities = false;  // which its own tile knows
  CellCapacities capacities = {};
};

// Flips at a vertex concern its own cells, and are judged by the cells of their
// vertices.
inline constexpr uint8_t kNumRings = 2;

// Collects cells around vertices from all tiles.
class PatchCollector {
 public:
  PatchCollector(const PlanVertices& plan, const TileParts& parts,
                 const SeamLabels& seam)
      : blocks_(plan.Blocks()), parts_(parts), seam_(seam) {}

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

  // The place of a cell in keys_, or of the slot where it belongs.
  size_t SlotOf(const CellKey& key) const;
  void GrowSlots();

  const PlanBlocks& blocks_;
  const TileParts& parts_;
  const SeamLabels& seam_;
  std::vector<CellKey> keys_;  // of all cells so far
  size_t num_taken_ = 0;
  std::vector<PatchCell> cells_;  // of the others
  // A table of open addresses: places in keys_, or kNone; a power of two of
  // them, half of which at most are taken.
  std::vector<uint32_t> slots_;
  // How many rings each vertex is off those that were asked for.
  std::unordered_map<uint32_t, uint8_t> rings_;
  std::map<uint32_t, std::vector<uint32_t>> waiting_;  // vertices by tile
};

}  // namespace colmap_ext
