#include "tests/tiles/memory_parts.h"

#include <utility>

namespace colmap_ext {

MemoryParts::MemoryParts(const SeenScene& scene, const MemoryPlan& plan) {
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    TileCut cut = CutTile(plan, tile, scene.centers, scene.options);
    seams_.push_back(SeamOf(cut));
    parts_.push_back(std::make_shared<TilePart>(
        TilePart{std::move(cut.tile), std::move(cut.labels)}));
    graphs_.push_back(std::move(cut.graph));
  }
}

}  // namespace colmap_ext
