#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tiles/plan_vertices.h"

namespace colmap_ext {

// A plan that is held whole.
class MemoryPlan : public PlanVertices {
 public:
  // Adds a tile, its vertices as they come.
  void Add(const std::vector<Eigen::Vector3f>& positions,
           const Observations& observations);

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override;
  Observations ReadObservations(uint32_t begin, uint32_t end) const override;

  const std::vector<Eigen::Vector3f>& positions() const { return positions_; }
  const Observations& observations() const { return observations_; }

 private:
  PlanBlocks blocks_;
  std::vector<Eigen::Vector3f> positions_;
  Observations observations_;
};

// Shares out points to tiles along the x axis, and puts each tile's along the
// curve. Of points at one position the first is there.
// \param observations  by points; none: nobody sees them
MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points, size_t num_tiles,
                  const Observations& observations = {});

}  // namespace colmap_ext
