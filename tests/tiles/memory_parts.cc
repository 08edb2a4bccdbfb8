#include "tests/tiles/memory_parts.h"

#include <utility>

namespace colmap_ext {

MemoryParts::MemoryParts(const SeenScene& scene, const MemoryPlan& plan) {
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    TileCut cut = CutTile(plan, tile, scene.centers, scene.options);
    seams_.push_back(SeamOf(cut));
    parts_.push_back({std::move(cut.tile), std::move(cut.labels.known)});
    parts_.back().tile.tetrahedra.points.assign(parts_.back().tile.ids.size(),
                                                Eigen::Vector3f::Zero());
    graphs_.push_back(std::move(cut.graph));
  }
}

PartVertices MemoryParts::ReadVertices(uint32_t tile) const {
  const TileTetrahedra& part = parts_[tile].tile;
  return {part.ids, part.tetrahedra.vertex_cells};
}

PartCells MemoryParts::ReadCells(uint32_t tile, uint32_t begin,
                                 uint32_t end) const {
  const auto range = [&](const auto& values) {
    using Values = std::decay_t<decltype(values)>;
    return Values(values.begin() + begin, values.begin() + end);
  };
  const FlowCapacities& graph = graphs_[tile];
  PartCells read;
  read.cells = range(parts_[tile].tile.tetrahedra.cells);
  read.labels = range(parts_[tile].labels);
  read.graph.capacities = range(graph.capacities);
  read.graph.source = range(graph.source);
  read.graph.sink = range(graph.sink);
  return read;
}

}  // namespace colmap_ext
