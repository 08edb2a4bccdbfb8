#pragma once

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "tests/mesh/manifold_links.h"

namespace colmap_ext {

// That the result is manifold, and has the topology of the mesh.
inline void ExpectSameTopology(const TriangleMesh& mesh,
                               const TriangleMesh& result) {
  const MeshReport before = Analyze(mesh);
  const MeshReport after = Analyze(result);
  EXPECT_TRUE(after.IsManifold()) << after.Defects();
  EXPECT_TRUE(HasManifoldLinks(result));
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(after.num_components, before.num_components);
  EXPECT_EQ(after.num_border_loops, before.num_border_loops);
}

}  // namespace colmap_ext
