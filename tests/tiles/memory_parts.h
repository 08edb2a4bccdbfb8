#pragma once

#include <cstdint>
#include <vector>

#include "tests/tiles/memory_plan.h"
#include "tests/tiles/seen_scene.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// The parts of all tiles of a plan, made at once.
class MemoryParts : public TileParts {
 public:
  MemoryParts(const SeenScene& scene, const MemoryPlan& plan);

  TileSeam ReadSeam(uint32_t tile) const override { return seams_[tile]; }
  TilePart ReadPart(uint32_t tile) const override { return parts_[tile]; }
  PartVertices ReadVertices(uint32_t tile) const override;
  uint32_t NumCells(uint32_t tile) const override {
    return static_cast<uint32_t>(parts_[tile].labels.size());
  }
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override;

  void SetSeam(uint32_t tile, const TileSeam& seam) { seams_[tile] = seam; }

 private:
  std::vector<TileSeam> seams_;
  std::vector<TilePart> parts_;
  std::vector<FlowCapacities> graphs_;
};

}  // namespace colmap_ext
