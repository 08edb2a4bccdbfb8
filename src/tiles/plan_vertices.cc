#include "tiles/plan_vertices.h"

#include <algorithm>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// The range of a sorted list of begins that a value lies in.
uint32_t RangeOf(const std::vector<uint32_t>& begins, uint32_t value) {
  return static_cast<uint32_t>(std::ranges::upper_bound(begins, value) -
                               begins.begin() - 1);
}

}  // namespace

uint32_t PlanBlocks::BlockOf(uint32_t vertex) const {
  return RangeOf(begins, vertex);
}

uint32_t PlanBlocks::TileOf(uint32_t vertex) const {
  return RangeOf(tile_begins, BlockOf(vertex));
}

uint32_t PlanBlocks::OwnerOf(const std::array<uint32_t, 4>& corners) const {
  std::array<uint32_t, 4> tiles;
  std::ranges::transform(corners, tiles.begin(), [this](uint32_t vertex) {
    return vertex == kInfiniteVertex ? vertex : TileOf(vertex);
  });
  uint32_t owner = kInfiniteVertex;
  int64_t most = 0;
  for (const uint32_t tile : tiles) {
    const int64_t count = std::ranges::count(tiles, tile);
    if (tile != kInfiniteVertex &&
        (count > most || (count == most && tile < owner))) {
      owner = tile;
      most = count;
    }
  }
  return owner;
}

void AddTile(const std::vector<Eigen::Vector3f>& positions,
             const Observations& observations, PlanBlocks* blocks) {
  const uint32_t first = blocks->NumVertices();
  const uint32_t num_vertices =
      ExpectIndexable(first + positions.size(), "vertices") - first;
  for (uint32_t begin = 0; begin < num_vertices; begin += kBlockVertices) {
    const uint32_t end = std::min(begin + kBlockVertices, num_vertices);
    Eigen::AlignedBox3f box;
    std::vector<uint32_t> views;
    bool has_ends = false;
    for (uint32_t i = begin; i < end; ++i) {
      box.extend(positions[i]);
      blocks->sum += positions[i].cast<double>();
      for (const Observation& observation : observations[i]) {
        views.push_back(observation.view);
      }
      has_ends = has_ends || observations.IsEnd(i);
    }
    SortUnique(&views);
    blocks->begins.push_back(first + end);
    blocks->boxes.push_back(box);
    blocks->views.AddRow(views);
    blocks->have_ends.push_back(has_ends);
  }
  blocks->tile_begins.push_back(static_cast<uint32_t>(blocks->NumBlocks()));
}

std::vector<Eigen::Vector3f> PositionsOf(const PlanVertices& plan,
                                         const std::vector<uint32_t>& ids) {
  const PlanBlocks& blocks = plan.Blocks();
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> of_block;
  uint32_t end = 0;
  uint32_t begin = 0;
  for (const uint32_t id : ids) {
    if (id >= end) {
      const uint32_t block = blocks.BlockOf(id);
      begin = blocks.begins[block];
      end = blocks.begins[block + 1];
      of_block = plan.ReadPositions(begin, end);
    }
    positions.push_back(of_block[id - begin]);
  }
  return positions;
}

}  // namespace colmap_ext
