#include "remesh/split_long_edges.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace colmap_ext {
namespace {

// The edges that are too long, the longest first.
std::vector<std::pair<float, uint32_t>> LongEdges(const AnchoredMesh& mesh,
                                                  float max_ratio) {
  std::vector<std::pair<float, uint32_t>> edges;
  for (uint32_t half = 0; half < mesh.edit.NumHalfEdges(); ++half) {
    if (mesh.edit.IsFirstOfEdge(half)) {
      const float ratio = mesh.RelativeLength(half);
      if (ratio > max_ratio) {
        edges.emplace_back(-ratio, half);
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

size_t SplitLongEdges(const ReferenceSurface& reference, float max_ratio,
                      AnchoredMesh* mesh) {
  // Each round halves the longest edges: enough for one of 65536 lengths.
  constexpr int kMaxRounds = 16;
  size_t num_splits = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto edges = LongEdges(*mesh, max_ratio);
    for (const auto& [ratio, half] : edges) {
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
