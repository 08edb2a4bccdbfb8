#include "tiles/patch_cells.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tiles/merged_plan.h"

namespace colmap_ext {
namespace tile_window_test {

// More cells than a block has.
TEST(TileWindow, ShowsTheCellsOfAPart) {
  const SeenScene scene = GroundScene(4000, 3);
  const MergedPlan merged(scene, 3);
  const MemoryParts& parts = merged.parts;
  size_t num_at_seams = 0;
  for (uint32_t tile = 0; tile < 3; ++tile) {
    const TilePart part = parts.ReadPart(tile);
    std::vector<uint8_t> labels = part.labels;
    ApplySeamLabels(merged.seam, part.tile, &labels);
    TileWindow window(parts, merged.seam, tile);
    std::vector<uint32_t> expected;
    std::vector<uint32_t> cells;
    for (uint32_t vertex = 0; vertex < part.tile.num_own; ++vertex) {
      IncidentCells(part.tile.tetrahedra, vertex, &expected);
      window.CellsAt(vertex, &cells);
      ASSERT_EQ(cells, expected);
      for (const uint32_t cell : cells) {
        ASSERT_EQ(window.CornersOf(cell), part.tile.CornersOf(cell));
        ASSERT_EQ(window.LabelOf(cell), labels[cell]);
        num_at_seams += part.labels[cell] == kNotKnown;
        const PartCells one = parts.ReadCells(tile, cell, cell + 1);
        const CellCapacities capacities = window.CapacitiesOf(cell);
        ASSERT_EQ(capacities.facets, one.graph.capacities[0]);
        ASSERT_EQ(capacities.source, one.graph.source[0]);
        ASSERT_EQ(capacities.sink, one.graph.sink[0]);
      }
    }
  }
  EXPECT_GT(num_at_seams, 100u);
}

}  // namespace tile_window_test
}  // namespace colmap_ext
