#include "tiles/tile_patches.h"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

// Puts parts together, each vertex once.
class PartBuilder {
 public:
  uint32_t Vertex(SurfaceId id, const Eigen::Vector3f& position,
                  const VertexAttributes& attributes, size_t vertex) {
    const auto [place, is_new] = places_.try_emplace(
        id, static_cast<uint32_t>(part_.mesh.vertices.size()));
    if (is_new) {
      part_.mesh.vertices.push_back(position);
      part_.ids.push_back(id);
      AddAttributes(attributes, vertex, &part_.attributes);
    }
    return place->second;
  }

  // \param vertex_of  the part's vertex of one of the facet's
  template <typename VertexOf>
  void AddFacet(Facet facet, SurfaceId id, const VertexOf& vertex_of) {
    for (uint32_t& vertex : facet) {
      vertex = vertex_of(vertex);
    }
    part_.mesh.facets.push_back(facet);
    part_.facet_ids.push_back(id);
  }

  SurfacePart Take() { return std::move(part_); }

 private:
  SurfacePart part_;
  std::unordered_map<SurfaceId, uint32_t> places_;
};

// Of the accepted patches.
std::vector<SurfaceId> RemovedFacets(const SurfaceStore& store,
                                     const std::vector<uint32_t>& patches) {
  std::vector<SurfaceId> removed;
  for (const uint32_t tile : patches) {
    Append(store.ReadRemoved(tile), &removed);
  }
  std::ranges::sort(removed);
  if (std::ranges::adjacent_find(removed) != removed.end()) {
    throw PatchError("two tiles have changed one face");
  }
  return removed;
}

// So that the lowest corner is the first.
Facet Turned(Facet facet) {
  std::rotate(facet.begin(), std::ranges::min_element(facet), facet.end());
  return facet;
}

}  // namespace

SurfacePart GatherSurface(const SurfaceStore& store,
                          const std::vector<uint32_t>& patches,
                          const AcceptBox& accept) {
  std::vector<uint32_t> accepted;
  std::ranges::copy_if(
      patches, std::back_inserter(accepted),
      [&](uint32_t tile) { return accept(store.PatchBox(tile)); });
  const std::vector<SurfaceId> removed = RemovedFacets(store, accepted);
  PartBuilder builder;
  const auto add = [&](const SurfacePart& part) {
    for (size_t i = 0; i < part.mesh.facets.size(); ++i) {
      const Facet& facet = part.mesh.facets[i];
      if (!std::ranges::binary_search(removed, part.facet_ids[i]) &&
          accept(BoxOf(part.mesh, facet))) {
        builder.AddFacet(facet, part.facet_ids[i], [&](uint32_t vertex) {
          return builder.Vertex(part.ids[vertex], part.mesh.vertices[vertex],
                                part.attributes, vertex);
        });
      }
    }
  };
  for (size_t block = 0; block < store.NumBlocks(); ++block) {
    if (accept(store.BlockBox(block))) {
      add(store.ReadBlock(block));
    }
  }
  for (const uint32_t tile : accepted) {
    add(store.ReadPatchPart(tile));
  }
  return builder.Take();
}

TilePatch MakePatch(uint32_t tile, const SurfacePart& before,
                    const FixedVertices& fixed, const TriangleMesh& after,
                    const VertexAttributes& attributes,
                    const std::vector<uint32_t>& sources) {
  TilePatch patch;
  std::set<Facet> kept;
  for (size_t i = 0; i < before.mesh.facets.size(); ++i) {
    const Facet& facet = before.mesh.facets[i];
    if (IsFixed(fixed, facet)) {
      kept.insert(Turned(facet));
    } else {
      patch.removed.push_back(before.facet_ids[i]);
      patch.box.extend(BoxOf(before.mesh, facet));
    }
  }
  std::ranges::sort(patch.removed);
  const auto source_of = [&](uint32_t vertex) {
    return sources.empty() ? kNone : sources[vertex];
  };
  PartBuilder builder;
  const auto vertex_of = [&](uint32_t vertex) {
    const uint32_t source = source_of(vertex);
    return builder.Vertex(
        source != kNone ? before.ids[source] : PatchId(tile, vertex),
        after.vertices[vertex], attributes, vertex);
  };
  size_t num_added = 0;
  for (const Facet& facet : after.facets) {
    const Facet old = {source_of(facet[0]), source_of(facet[1]),
                       source_of(facet[2])};
    if (std::ranges::find(old, kNone) == old.end() &&
        kept.erase(Turned(old)) > 0) {
      continue;
    }
    builder.AddFacet(facet, PatchId(tile, num_added++), vertex_of);
    patch.box.extend(BoxOf(after, facet));
  }
  if (!kept.empty()) {
    throw std::logic_error("a face that was to stay is gone");
  }
  patch.part = builder.Take();
  return patch;
}

}  // namespace colmap_ext
