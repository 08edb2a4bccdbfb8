#include "tiles/plan_vertices.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace plan_vertices_test {

TEST(AddTile, RefusesMoreVerticesThanCanBeNumbered) {
  const std::vector<Eigen::Vector3f> positions(10, Eigen::Vector3f::Zero());
  Observations observations;
  observations.offsets.assign(positions.size() + 1, 0);
  const auto num_vertices = static_cast<uint32_t>(positions.size());
  for (const uint32_t missing : {0u, 1u, num_vertices - 1}) {
    PlanBlocks blocks;
    blocks.begins = {0, UINT32_MAX - missing};
    EXPECT_THROW(AddTile(positions, observations, &blocks),
                 std::invalid_argument);
    EXPECT_EQ(blocks.NumVertices(), UINT32_MAX - missing);
    EXPECT_EQ(blocks.NumTiles(), 0u);
  }
  PlanBlocks blocks;
  blocks.begins = {0, UINT32_MAX - num_vertices};
  AddTile(positions, observations, &blocks);
  EXPECT_EQ(blocks.NumVertices(), UINT32_MAX);
  EXPECT_EQ(blocks.NumTiles(), 1u);
}

}  // namespace plan_vertices_test
}  // namespace colmap_ext
