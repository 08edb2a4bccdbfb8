#include "remesh/split_long_edges.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace colmap_ext {
namespace {

// The edges that are too long, the longest first.
std::vector<uint32_t> LongEdges(const AnchoredMesh& mesh, float max_ratio) {
  return mesh.EdgesBy([&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh.RelativeLength(half);
    return ratio > max_ratio ? std::optional(-ratio) : std::nullopt;
  });
}

}  // namespace

size_t SplitLongEdges(const ReferenceSurface& reference, float max_ratio,
                      AnchoredMesh* mesh) {
  // Each round halves the longest edges: enough for one of 65536 lengths.
  constexpr int kMaxRounds = 16;
  size_t num_splits = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<uint32_t> edges = LongEdges(*mesh, max_ratio);
    for (const uint32_t half : edges) {
      if (!(mesh->RelativeLength(half) > max_ratio)) {
        continue;  // Half of an edge that was split before.
      }
      const Anchor& from = mesh->anchors[mesh->edit.From(half)];
      const Anchor& to = mesh->anchors[mesh->edit.To(half)];
      const uint32_t middle = mesh->edit.Split(half);
      mesh->anchors.push_back(reference.Nearest(mesh->edit.Position(middle),
                                                from.normal + to.normal,
                                                from.source.facet));
    }
    num_splits += edges.size();
    if (edges.empty()) {
      break;
    }
  }
  return num_splits;
}

}  // namespace colmap_ext
