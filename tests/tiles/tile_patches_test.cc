#include "tiles/tile_patches.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "spatial/facet_tree.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::tile_patches_test {

// A surface in memory, in blocks of ten facets.
class MemorySurface : public SurfaceStore {
 public:
  explicit MemorySurface(TriangleMesh mesh) : mesh_(std::move(mesh)) {}

  size_t NumBlocks() const override { return (mesh_.facets.size() + 9) / 10; }
  Eigen::AlignedBox3f BlockBox(size_t block) const override {
    Eigen::AlignedBox3f box;
    for (const Facet& facet : ReadBlock(block).mesh.facets) {
      box.extend(BoxOf(mesh_, facet));
    }
    return box;
  }
  SurfacePart ReadBlock(size_t block) const override {
    SurfacePart part;
    part.mesh.vertices = mesh_.vertices;
    for (size_t i = 0; i < mesh_.vertices.size(); ++i) {
      part.ids.push_back(BaseId(i));
      part.attributes.views.EndRow();
    }
    const size_t last = std::min(10 * block + 10, mesh_.facets.size());
    for (size_t i = 10 * block; i < last; ++i) {
      part.mesh.facets.push_back(mesh_.facets[i]);
      part.facet_ids.push_back(BaseId(i));
    }
    return part;
  }
  Eigen::AlignedBox3f PatchBox(uint32_t tile) const override {
    return patches.at(tile).box;
  }
  std::vector<SurfaceId> ReadRemoved(uint32_t tile) const override {
    return patches.at(tile).removed;
  }
  SurfacePart ReadPatchPart(uint32_t tile) const override {
    return patches.at(tile).part;
  }

  std::map<uint32_t, TilePatch> patches;

 private:
  TriangleMesh mesh_;
};

bool AcceptAll(const Eigen::AlignedBox3f& /*box*/) { return true; }

// A patch that moves what lies in a box, and takes one facet in three there
// apart.
TilePatch Change(const SurfaceStore& store, const std::vector<uint32_t>& before,
                 uint32_t tile, const Eigen::AlignedBox3f& box) {
  const SurfacePart part = GatherSurface(
      store, before,
      [&](const Eigen::AlignedBox3f& other) { return other.intersects(box); });
  TriangleMesh after = part.mesh;
  VertexAttributes attributes = part.attributes;
  FixedVertices fixed;
  std::vector<uint32_t> sources;
  for (uint32_t i = 0; i < part.mesh.vertices.size(); ++i) {
    fixed.push_back(box.contains(part.mesh.vertices[i]) ? 0 : 1);
    sources.push_back(fixed[i] != 0 ? i : kNone);
    if (fixed[i] == 0) {
      after.vertices[i] += Eigen::Vector3f(0, 0, 0.01F);
    }
  }
  for (size_t i = 0; i < part.mesh.facets.size(); i += 3) {
    const Facet facet = part.mesh.facets[i];
    if (!IsFixed(fixed, facet)) {
      const auto middle = static_cast<uint32_t>(after.vertices.size());
      after.vertices.emplace_back(BoxOf(after, facet).center());
      attributes.views.EndRow();
      sources.push_back(kNone);
      after.facets[i] = {facet[0], facet[1], middle};
      after.facets.push_back({facet[1], facet[2], middle});
      after.facets.push_back({facet[2], facet[0], middle});
    }
  }
  return MakePatch(tile, part, fixed, after, attributes, sources);
}

Eigen::AlignedBox3f Left() {
  return {Eigen::Vector3f(-5, -5, -5), Eigen::Vector3f(0.1F, 5, 5)};
}

Eigen::AlignedBox3f Right() {
  return {Eigen::Vector3f(-0.1F, -5, -5), Eigen::Vector3f(5, 5, 5)};
}

TEST(GatherSurface, OfNoPatchesIsTheBase) {
  const TriangleMesh mesh = MakeBumpySphere(0.2F);
  const SurfacePart part = GatherSurface(MemorySurface(mesh), {}, &AcceptAll);
  ASSERT_EQ(part.mesh.facets.size(), mesh.facets.size());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(part.ids[part.mesh.facets[i][k]], mesh.facets[i][k]);
    }
  }
}

TEST(GatherSurface, OfPatchesOverEachOtherIsClosed) {
  const TriangleMesh mesh = MakeBumpySphere(0.2F);
  MemorySurface store(mesh);
  store.patches[4] = Change(store, {}, 4, Left());
  EXPECT_GT(store.patches[4].removed.size(), 10);
  EXPECT_LT(store.patches[4].removed.size(), mesh.facets.size());
  store.patches[2] = Change(store, {4}, 2, Right());
  const SurfacePart whole = GatherSurface(store, {4, 2}, &AcceptAll);
  const MeshReport report = Analyze(whole.mesh);
  EXPECT_TRUE(report.IsManifold()) << report.Defects();
  EXPECT_EQ(report.num_border_edges, 0);
  EXPECT_EQ(report.euler, Analyze(mesh).euler);
  EXPECT_GT(whole.mesh.facets.size(), mesh.facets.size());
}

TEST(GatherSurface, TakesNoMoreThanIsAccepted) {
  MemorySurface store(MakeBumpySphere(0.2F));
  store.patches[0] = Change(store, {}, 0, Left());
  const Eigen::AlignedBox3f box(Eigen::Vector3f(-0.3F, -0.3F, -5),
                                Eigen::Vector3f(0.3F, 0.3F, 5));
  const auto accept = [&](const Eigen::AlignedBox3f& other) {
    return box.intersects(other);
  };
  const SurfacePart whole = GatherSurface(store, {0}, &AcceptAll);
  const SurfacePart part = GatherSurface(store, {0}, accept);
  std::set<SurfaceId> expected;
  for (size_t i = 0; i < whole.facet_ids.size(); ++i) {
    if (accept(BoxOf(whole.mesh, whole.mesh.facets[i]))) {
      expected.insert(whole.facet_ids[i]);
    }
  }
  EXPECT_EQ(std::set(part.facet_ids.begin(), part.facet_ids.end()), expected);
  EXPECT_LT(part.facet_ids.size(), whole.facet_ids.size());
}

TEST(GatherSurface, RefusesFacetsThatAreRemovedTwice) {
  MemorySurface store(MakeBumpySphere(0.2F));
  store.patches[0] = Change(store, {}, 0, Left());
  store.patches[1] = Change(store, {}, 1, Right());
  EXPECT_THROW(GatherSurface(store, {0, 1}, &AcceptAll), PatchError);
}

TEST(MakePatch, OfNoChangeMakesTheSameSurface) {
  const TriangleMesh mesh = MakeBumpySphere(0.3F);
  MemorySurface store(mesh);
  const SurfacePart part = GatherSurface(store, {}, &AcceptAll);
  store.patches[0] = MakePatch(0, part, FixedVertices(part.ids.size(), 0),
                               part.mesh, part.attributes, {});
  EXPECT_EQ(store.patches[0].removed.size(), mesh.facets.size());
  const SurfacePart again = GatherSurface(store, {0}, &AcceptAll);
  EXPECT_EQ(again.mesh, part.mesh);
}

}  // namespace colmap_ext::tile_patches_test
