#include "remesh/improve_angles.h"

#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mesh/facet_normals.h"
#include "remesh/isotropic_remeshing.h"
#include "tests/mesh/same_topology.h"
#include "tests/mesh/shapes.h"
#include "tests/remesh/mesh_measures.h"

namespace colmap_ext {
namespace improve_angles_test {

constexpr float kLength = 0.1F;

// Of well-shaped facets.
TriangleMesh MakeEven(const TriangleMesh& mesh) {
  return RemeshIsotropically(
             mesh, std::vector<float>(mesh.vertices.size(), kLength),
             std::vector<float>(mesh.vertices.size(), 0.1F * kLength))
      .mesh;
}

// Moves some vertices along an edge, nearly up to its other end: needles and
// caps.
TriangleMesh MakeThinFacets(TriangleMesh mesh, Random* random) {
  std::set<uint32_t> used;
  for (const auto& [a, b, c] : mesh.facets) {
    if (random->Chance(0.02) && used.insert(a).second &&
        used.insert(b).second && used.insert(c).second) {
      mesh.vertices[a] = 0.1F * mesh.vertices[a] + 0.9F * mesh.vertices[b];
    }
  }
  return mesh;
}

std::vector<TriangleMesh> EvenMeshes() {
  return {MakeEven(MakeBumpySphere(0.1F)), MakeEven(MakeBumpyCap(0.1F)),
          MakeEven(MakeRoundTorus(0.1F))};
}

double ShareBelow(double angle, const TriangleMesh& mesh) {
  const std::vector<double> angles = SmallestAngles(mesh);
  return static_cast<double>(
             std::count_if(angles.begin(), angles.end(),
                           [&](double smallest) { return smallest < angle; })) /
         static_cast<double>(angles.size());
}

TEST(ImproveAngles, ThinFacetsGoAndTheSurfaceStays) {
  Random random(2);
  for (const TriangleMesh& even : EvenMeshes()) {
    const TriangleMesh thin = MakeThinFacets(even, &random);
    ASSERT_GT(ShareBelow(10, thin), 0.01);
    const ImprovedMesh improved = ImproveAngles(thin);
    ExpectSameTopology(thin, improved.mesh);
    EXPECT_LT(ShareBelow(10, improved.mesh), 0.1 * ShareBelow(10, thin));
    EXPECT_LT(Distance(improved.mesh, thin), 0.25 * kLength);
    EXPECT_LT(Distance(thin, improved.mesh), 0.25 * kLength);
  }
}

// Facets that are well shaped keep their corners, unless a neighbor is not.
TEST(ImproveAngles, LeavesTheRestAsItIs) {
  Random random(3);
  for (const TriangleMesh& even : EvenMeshes()) {
    const TriangleMesh thin = MakeThinFacets(even, &random);
    const ImprovedMesh improved = ImproveAngles(thin);
    ASSERT_EQ(improved.facet_sources.size(), improved.mesh.facets.size());
    size_t num_kept = 0;
    for (size_t i = 0; i < improved.mesh.facets.size(); ++i) {
      bool is_kept = true;
      for (int k = 0; k < 3; ++k) {
        is_kept = is_kept &&
                  improved.mesh.vertices[improved.mesh.facets[i][k]] ==
                      thin.vertices[thin.facets[improved.facet_sources[i]][k]];
      }
      num_kept += is_kept ? 1 : 0;
    }
    EXPECT_GT(num_kept, improved.mesh.facets.size() * 2 / 3);
  }
}

TEST(ImproveAngles, AMeshWithoutThinFacetsIsLeftAlone) {
  TriangleMesh mesh;
  const int n = 10;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      mesh.vertices.emplace_back(i + 0.5F * j, 0.866F * j, 0.1F * i * j);
    }
  }
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) {
      const uint32_t at = i * (n + 1) + j;
      mesh.facets.push_back({at, at + n + 1, at + 1});
      mesh.facets.push_back({at + 1, at + n + 1, at + n + 2});
    }
  }
  const ImprovedMesh improved = ImproveAngles(mesh);
  EXPECT_EQ(improved.mesh.facets, mesh.facets);
  EXPECT_EQ(improved.mesh.vertices, mesh.vertices);
}

TEST(ImproveAngles, SourcesAreWhereTheVerticesAre) {
  Random random(4);
  const TriangleMesh thin = MakeThinFacets(EvenMeshes()[1], &random);
  const ImprovedMesh improved = ImproveAngles(thin);
  ASSERT_EQ(improved.sources.size(), improved.mesh.vertices.size());
  const std::vector<Eigen::Vector3f> positions =
      ValuesAt(improved.sources, thin, thin.vertices);
  for (size_t i = 0; i < positions.size(); ++i) {
    EXPECT_LT((positions[i] - improved.mesh.vertices[i]).norm(), 1e-5F);
  }
}

TEST(ImproveAngles, DoesNotDependOnTheNumberOfThreads) {
  Random random(5);
  const TriangleMesh thin = MakeThinFacets(EvenMeshes()[0], &random);
  const ImprovedMesh several = ImproveAngles(thin);
  const tbb::global_control one_thread(
      tbb::global_control::max_allowed_parallelism, 1);
  const ImprovedMesh one = ImproveAngles(thin);
  EXPECT_EQ(several.mesh.vertices, one.mesh.vertices);
  EXPECT_EQ(several.mesh.facets, one.mesh.facets);
  EXPECT_EQ(several.facet_sources, one.facet_sources);
}

}  // namespace improve_angles_test
}  // namespace colmap_ext
