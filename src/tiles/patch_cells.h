#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "tiles/cell_key.h"
#include "tiles/plan_vertices.h"
#include "tiles/seam_cut.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// A cell of a patch by the plan's vertices, oriented, the first two the lowest.
struct PatchCell {
  CellKey corners;
  uint8_t label = 0;
  bool has_capacities = false;  // which its own tile knows
  std::array<uint32_t, 4> capacities = {0, 0, 0, 0};
  uint32_t source = 0;
  uint32_t sink = 0;
};

using Ring = std::unordered_set<uint32_t>;

// Flips at a vertex concern its own cells, and are judged by the cells of their
// vertices.
inline constexpr uint8_t kNumRings = 3;

// Collects cells around vertices from all tiles.
class PatchCollector {
 public:
  PatchCollector(const PlanVertices& plan, const TileParts& parts,
                 const SeamLabels& seam)
      : blocks_(plan.Blocks()), parts_(parts), seam_(seam) {}

  // All singular vertices, ascending.
  std::vector<uint32_t> FindSingular() const;

  // Adds all cells in kNumRings rings around the vertices, reading few tiles
  // more than once.
  // \return the vertices with those at the cells of the first ring
  Ring AddRings(const std::vector<uint32_t>& vertices);

  // In the order of their corners. To be called last.
  std::vector<PatchCell> Take();

 private:
  // A part with the labels of the seams.
  struct Tile {
    std::shared_ptr<const TilePart> part;
    FlowCapacities graph;
    std::vector<uint8_t> labels;
  };

  Tile Read(uint32_t tile) const;
  // Calls function(from, cell) for the cells at vertices of a tile, more than
  // once for those at several.
  template <typename Ids, typename Function>
  void ForEachCellAt(uint32_t tile, const Ids& ids,
                     const Function& function) const;
  void AddRingsIn(uint32_t tile, std::vector<uint32_t> ids);
  void Reach(uint32_t id, uint8_t ring, std::vector<uint32_t>* here,
             uint32_t tile);
  void AddCell(uint32_t tile, const Tile& from, uint32_t index);
  void AddMissingCapacities();

  // The place of a cell in cells_, or of the slot where it belongs.
  size_t SlotOf(const CellKey& key) const;
  void GrowSlots();

  const PlanBlocks& blocks_;
  const TileParts& parts_;
  const SeamLabels& seam_;
  std::vector<PatchCell> cells_;
  // A table of open addresses: places in cells_, or kNoSlot; a power of two of
  // them, half of which at most are taken.
  std::vector<uint32_t> slots_;
  // How many rings each vertex is off those that were asked for.
  std::unordered_map<uint32_t, uint8_t> rings_;
  std::map<uint32_t, std::vector<uint32_t>> waiting_;  // vertices by tile
};

}  // namespace colmap_ext
