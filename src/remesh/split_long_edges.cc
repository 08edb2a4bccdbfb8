#include "remesh/remeshing_steps.h"

#include <array>
#include <optional>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// The edges that are too long, the longest first.
std::vector<uint32_t> LongEdges(const AnchoredMesh& mesh, float max_ratio) {
  return mesh.EdgesBy([&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh.RelativeLength(half);
    return ratio > max_ratio && !mesh.IsFixedEdge(half) ? std::optional(-ratio)
                                                        : std::nullopt;
  });
}

// What an edge's middle is next to on the reference.
struct Middle {
  std::array<uint32_t, 2> ends{};
  Anchor anchor;
};

Middle MiddleOf(const ReferenceSurface& reference, const AnchoredMesh& mesh,
                uint32_t half) {
  const uint32_t from = mesh.edit.From(half);
  const uint32_t to = mesh.edit.To(half);
  const Anchor& anchor = mesh.anchors[from];
  return {{from, to},
          reference.Nearest(
              (mesh.edit.Position(from) + mesh.edit.Position(to)) / 2,
              anchor.normal + mesh.anchors[to].normal, anchor.source.facet)};
}

// \param edges  half-edges; those that are short enough by then stay
void Split(const ReferenceSurface& reference, float max_ratio,
           const std::vector<uint32_t>& edges, AnchoredMesh* mesh) {
  // Found in parallel from the ends, which do not move.
  std::vector<Middle> middles(edges.size());
  tbb::parallel_for(size_t{0}, edges.size(), [&](size_t i) {
    middles[i] = MiddleOf(reference, *mesh, edges[i]);
  });
  for (size_t i = 0; i < edges.size(); ++i) {
    const uint32_t half = edges[i];
    if (!(mesh->RelativeLength(half) > max_ratio)) {
      continue;  // Half of an edge that was split before.
    }
    const std::array<uint32_t, 2> ends = {mesh->edit.From(half),
                                          mesh->edit.To(half)};
    mesh->anchors.push_back(middles[i].ends == ends
                                ? middles[i].anchor
                                : MiddleOf(reference, *mesh, half).anchor);
    mesh->edit.Split(half);
  }
}

}  // namespace

size_t SplitLongEdges(const ReferenceSurface& reference, float max_ratio,
                      AnchoredMesh* mesh) {
  // Each round halves the longest edges: enough for one of 65536 lengths.
  constexpr int kMaxRounds = 16;
  size_t num_splits = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<uint32_t> edges = LongEdges(*mesh, max_ratio);
    Split(reference, max_ratio, edges, mesh);
    num_splits += edges.size();
    if (edges.empty()) {
      break;
    }
  }
  return num_splits;
}

}  // namespace colmap_ext
