#include "tiles/block_cache.h"

#include <utility>

namespace colmap_ext {
namespace {

BlockVertices WithBoxes(std::vector<Eigen::Vector3f> positions) {
  BlockVertices block{std::move(positions), {}};
  for (size_t i = 0; i < block.positions.size(); ++i) {
    if (i % kGroupVertices == 0) {
      block.boxes.emplace_back();
    }
    block.boxes.back().extend(block.positions[i]);
  }
  return block;
}

}  // namespace

std::shared_ptr<BlockVertices> BlockCache::Read(uint32_t block) {
  const uint32_t begin = plan_.Blocks().begins[block];
  const uint32_t end = plan_.Blocks().begins[block + 1];
  // With a box for each group.
  constexpr size_t kVertexBytes = sizeof(Eigen::Vector3f) +
                                  sizeof(Eigen::AlignedBox3f) / kGroupVertices +
                                  1;
  return cache_.Get(block, (end - begin) * kVertexBytes, [&] {
    return std::make_shared<BlockVertices>(
        WithBoxes(plan_.ReadPositions(begin, end)));
  });
}

}  // namespace colmap_ext
