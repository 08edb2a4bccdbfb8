#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/lru_cache.h"
#include "tiles/plan_vertices.h"

namespace colmap_ext {

// Vertices of a block whose box is known.
inline constexpr uint32_t kGroupVertices = 32;

// The vertices of a block.
struct BlockVertices {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::AlignedBox3f> boxes;  // of each kGroupVertices of them
};

// Keeps the blocks of a plan that were read last. Safe from several threads.
class BlockCache {
 public:
  explicit BlockCache(const PlanVertices& plan)
      : plan_(plan), cache_(kCacheBytes) {}

  std::shared_ptr<BlockVertices> Read(uint32_t block);

 private:
  static constexpr size_t kCacheBytes = size_t{256} << 20;

  const PlanVertices& plan_;
  LruCache<BlockVertices> cache_;
};

}  // namespace colmap_ext
