#include "remesh/anchored_mesh.h"

#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// \param edges  half-edges; those that are short enough by then stay
void Split(float max_ratio, const std::vector<uint32_t>& edges,
           AnchoredMesh* mesh) {
  const auto ends_of = [mesh](uint32_t half) {
    return std::pair(mesh->edit.From(half), mesh->edit.To(half));
  };
  // Found in parallel from the ends, which do not move.
  std::vector<std::pair<uint32_t, uint32_t>> ends(edges.size());
  std::vector<Anchor> anchors(edges.size());
  tbb::parallel_for(size_t{0}, edges.size(), [&](size_t i) {
    ends[i] = ends_of(edges[i]);
    anchors[i] = mesh->AnchorOfMiddle(edges[i]);
  });
  for (size_t i = 0; i < edges.size(); ++i) {
    const uint32_t half = edges[i];
    if (mesh->RelativeLength(half) > max_ratio) {  // else it was split before
      mesh->anchors.push_back(
          ends[i] == ends_of(half) ? anchors[i] : mesh->AnchorOfMiddle(half));
      mesh->edit.Split(half);
    }
  }
}

}  // namespace

void SplitLongEdges(float max_ratio, AnchoredMesh* mesh) {
  // Each round halves the longest edges: enough for one of 65536 lengths.
  constexpr int kMaxRounds = 16;
  const auto is_long = [&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh->RelativeLength(half);
    return ratio > max_ratio && !mesh->IsFixedEdge(half) ? std::optional(-ratio)
                                                         : std::nullopt;
  };
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<uint32_t> edges = mesh->EdgesBy(is_long);
    if (edges.empty()) {
      return;
    }
    Split(max_ratio, edges, mesh);
  }
}

}  // namespace colmap_ext
