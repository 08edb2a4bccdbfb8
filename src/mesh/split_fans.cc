#include "mesh/split_fans.h"

#include <algorithm>
#include <tuple>
#include <unordered_set>
#include <utility>

#include <tbb/parallel_sort.h>

#include "mesh/adjacency.h"
#include "mesh/editable_mesh.h"

namespace colmap_ext {
namespace {

// Numbers the fans in the order in which corners use them and replaces the
// corners' vertices by them.
void CopyVerticesPerFan(const std::vector<uint32_t>& partners,
                        FanSplit* split) {
  std::vector<Facet>& facets = split->mesh.facets;
  const std::vector<Eigen::Vector3f> positions =
      std::exchange(split->mesh.vertices, {});
  split->mesh.vertices.reserve(positions.size());
  split->from.vertices.reserve(positions.size());
  std::vector<bool> is_used(positions.size(), false);
  // A corner is named by the half-edge that leaves it.
  std::vector<bool> is_done(3 * facets.size(), false);
  for (uint32_t half = 0; half < is_done.size(); ++half) {
    if (is_done[half]) {
      continue;
    }
    const uint32_t source = FromVertex(facets, half);
    const auto vertex = static_cast<uint32_t>(split->mesh.vertices.size());
    split->mesh.vertices.push_back(positions[source]);
    split->from.vertices.push_back({source, source});
    split->num_split_vertices += is_used[source] ? 1 : 0;
    is_used[source] = true;
    // Around the vertex to one side, then, where the fan is open, to the other.
    const auto visit = [&](uint32_t corner) {
      facets[corner / 3][corner % 3] = vertex;
      is_done[corner] = true;
    };
    visit(half);
    for (uint32_t at = partners[half];
         at != kNone && !is_done[NextHalfEdge(at)];
         at = partners[NextHalfEdge(at)]) {
      visit(NextHalfEdge(at));
    }
    for (uint32_t corner = partners[PreviousHalfEdge(half)];
         corner != kNone && !is_done[corner];
         corner = partners[PreviousHalfEdge(corner)]) {
      visit(corner);
    }
  }
}

// Half-edges, one a sheet, of edges that other sheets share.
std::vector<uint32_t> SharedSheets(const std::vector<Facet>& facets,
                                   const std::vector<uint32_t>& partners) {
  std::vector<uint8_t> is_shared(partners.size(), 0);
  ForEachEdge</*kInParallel=*/true>(facets, [&](auto first, auto last) {
    if (last - first == 1 ||
        (last - first == 2 && FromVertex(facets, first->second) !=
                                  FromVertex(facets, (first + 1)->second))) {
      return;
    }
    const uint32_t kept = first->second;
    for (auto half = first + 1; half != last; ++half) {
      const uint32_t partner = partners[half->second];
      is_shared[half->second] =
          partner != kept && (partner == kNone || half->second < partner);
    }
  });
  std::vector<uint32_t> shared = Marked(is_shared);
  std::ranges::sort(shared, {}, [&](uint32_t half) {  // by edges
    return std::tuple(
        std::minmax({FromVertex(facets, half), ToVertex(facets, half)}), half);
  });
  return shared;
}

// Puts the facets in the order of those that they are parts of, and vertices in
// the order in which the facets use them.
void OrderByUse(DerivedMesh* split) {
  const DerivedMesh old = std::exchange(*split, {});
  std::vector<uint32_t> order = Iota(old.mesh.facets.size());
  std::ranges::stable_sort(
      order, {}, [&](uint32_t facet) { return old.from.facets[facet]; });
  std::vector<uint32_t> numbers(old.mesh.vertices.size(), kNone);
  for (const uint32_t facet : order) {
    Facet& added = split->mesh.facets.emplace_back(old.mesh.facets[facet]);
    split->from.facets.push_back(old.from.facets[facet]);
    for (uint32_t& vertex : added) {
      uint32_t& number = numbers[vertex];
      if (number == kNone) {
        number = static_cast<uint32_t>(split->mesh.vertices.size());
        split->mesh.vertices.push_back(old.mesh.vertices[vertex]);
        split->from.vertices.push_back(old.from.vertices[vertex]);
      }
      vertex = number;
    }
  }
}

bool IsValid(const TriangleMesh& mesh, const Facet& facet) {
  return std::ranges::all_of(facet, [&mesh](uint32_t vertex) {
    return vertex < mesh.vertices.size() && mesh.vertices[vertex].allFinite();
  });
}

// [F] whether a facet before has the same three vertices.
std::vector<uint8_t> FindRepeated(const std::vector<Facet>& facets) {
  std::vector<std::pair<Facet, uint32_t>> sorted(facets.size());
  for (uint32_t i = 0; i < facets.size(); ++i) {
    sorted[i] = {facets[i], i};
    std::ranges::sort(sorted[i].first);
  }
  tbb::parallel_sort(sorted.begin(), sorted.end());
  std::vector<uint8_t> is_repeated(facets.size(), 0);
  for (size_t i = 1; i < sorted.size(); ++i) {
    is_repeated[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  }
  return is_repeated;
}

}  // namespace

FanSplit SplitFans(TriangleMesh mesh, std::vector<uint32_t> partners) {
  FanSplit split;
  split.mesh = std::move(mesh);
  split.from.facets = Iota(split.mesh.facets.size());
  CopyVerticesPerFan(partners, &split);
  std::vector<uint32_t> shared = SharedSheets(split.mesh.facets, partners);
  if (shared.empty()) {
    return split;
  }
  EditableMesh edit(std::move(split.mesh), std::move(partners));
  for (; !shared.empty();
       shared = SharedSheets(edit.mesh().facets, edit.partners())) {
    // A facet is cut once a round: its other half-edges are not what they were.
    std::unordered_set<uint32_t> cut_facets;
    for (const uint32_t half : shared) {
      const uint32_t facet = half / 3;
      const uint32_t partner = edit.Partner(half);
      const uint32_t other = partner == kNone ? facet : partner / 3;
      if (cut_facets.contains(facet) || cut_facets.contains(other)) {
        continue;
      }
      cut_facets.insert({facet, other});
      auto& [vertices, facets] = split.from;
      vertices.push_back(
          {vertices[edit.From(half)][0], vertices[edit.To(half)][0]});
      facets.push_back(facets[facet]);
      if (partner != kNone) {
        facets.push_back(facets[other]);
      }
      edit.Split(half);
      ++split.num_midpoints;
    }
  }
  split.mesh = edit.mesh();
  OrderByUse(&split);
  return split;
}

FanSplit SplitFans(TriangleMesh mesh) {
  std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  return SplitFans(std::move(mesh), std::move(partners));
}

ManifoldRepair RepairManifold(const TriangleMesh& mesh) {
  ManifoldRepair repair;
  TriangleMesh sound{mesh.vertices, {}};
  std::vector<uint32_t> sources;  // [F] of what is sound
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    if (!IsValid(mesh, mesh.facets[i])) {
      ++repair.num_invalid_facets;
    } else if (RepeatsVertex(mesh.facets[i])) {
      ++repair.num_degenerate_facets;
    } else {
      sound.facets.push_back(mesh.facets[i]);
      sources.push_back(i);
    }
  }
  const std::vector<uint8_t> is_repeated = FindRepeated(sound.facets);
  size_t num_kept = 0;
  for (size_t i = 0; i < sound.facets.size(); ++i) {
    if (is_repeated[i] == 0) {
      sources[num_kept] = sources[i];
      sound.facets[num_kept++] = sound.facets[i];
    }
  }
  repair.num_duplicate_facets = sound.facets.size() - num_kept;
  sound.facets.resize(num_kept);
  static_cast<FanSplit&>(repair) = SplitFans(std::move(sound));
  for (uint32_t& facet : repair.from.facets) {
    facet = sources[facet];
  }
  repair.num_unused_vertices =
      mesh.vertices.size() + repair.num_split_vertices + repair.num_midpoints -
      repair.mesh.vertices.size();
  return repair;
}

}  // namespace colmap_ext
