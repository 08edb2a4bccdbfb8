#include "mesh/fan_split.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "base/union_find.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

// Numbers the fans in the order in which corners use them and replaces the
// corners' vertices by them.
void CopyVerticesPerFan(const TriangleMesh& mesh,
                        const std::vector<uint32_t>& partners,
                        FanSplit* split) {
  const auto num_corners = static_cast<uint32_t>(3 * mesh.facets.size());
  // A corner is named by the half-edge that leaves it.
  UnionFind fans(num_corners);
  for (uint32_t half = 0; half < num_corners; ++half) {
    if (partners[half] != kNoPartner) {
      fans.Join(half, NextHalfEdge(partners[half]));
    }
  }
  std::vector<uint32_t> vertex_of_fan(num_corners, UINT32_MAX);
  std::vector<uint8_t> is_used(mesh.vertices.size(), 0);
  split->mesh.facets.resize(mesh.facets.size());
  for (uint32_t half = 0; half < num_corners; ++half) {
    uint32_t& vertex = vertex_of_fan[fans.Find(half)];
    if (vertex == UINT32_MAX) {
      const uint32_t source = FromVertex(mesh.facets, half);
      vertex = static_cast<uint32_t>(split->mesh.vertices.size());
      split->mesh.vertices.push_back(mesh.vertices[source]);
      split->sources.push_back({source, source});
      split->num_split_vertices += is_used[source];
      is_used[source] = 1;
    }
    split->mesh.facets[half / 3][half % 3] = vertex;
  }
}

// Cuts a facet in two at a vertex on one of its half-edges. The half-edge keeps
// its first part.
// \return the half-edge that is its second part, in the new facet
uint32_t CutFacet(uint32_t half, uint32_t middle, std::vector<Facet>* facets,
                  std::vector<uint32_t>* partners) {
  const uint32_t old_next = NextHalfEdge(half);
  const uint32_t to = ToVertex(*facets, half);
  const uint32_t apex = FromVertex(*facets, NextHalfEdge(old_next));
  const auto new_half = static_cast<uint32_t>(partners->size());
  facets->push_back({middle, to, apex});
  (*facets)[half / 3][old_next % 3] = middle;
  partners->insert(partners->end(),
                   {kNoPartner, (*partners)[old_next], old_next});
  if ((*partners)[old_next] != kNoPartner) {
    (*partners)[(*partners)[old_next]] = new_half + 1;
  }
  (*partners)[old_next] = new_half + 2;
  return new_half;
}

// Gives a sheet's edge a midpoint of its own.
void SubdivideEdge(uint32_t half, FanSplit* split,
                   std::vector<uint32_t>* partners) {
  TriangleMesh& mesh = split->mesh;
  const uint32_t from = FromVertex(mesh.facets, half);
  const uint32_t to = ToVertex(mesh.facets, half);
  const auto middle = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(0.5f * (mesh.vertices[from] + mesh.vertices[to]));
  split->sources.push_back({split->sources[from][0], split->sources[to][0]});
  ++split->num_midpoints;
  const uint32_t partner = (*partners)[half];
  split->facet_sources.push_back(split->facet_sources[half / 3]);
  const uint32_t second = CutFacet(half, middle, &mesh.facets, partners);
  if (partner != kNoPartner) {
    split->facet_sources.push_back(split->facet_sources[partner / 3]);
    const uint32_t partner_second =
        CutFacet(partner, middle, &mesh.facets, partners);
    (*partners)[half] = partner_second;
    (*partners)[partner_second] = half;
    (*partners)[second] = partner;
    (*partners)[partner] = second;
  }
}

// Half-edges, one a sheet, of edges that other sheets share.
std::vector<uint32_t> SharedSheets(const std::vector<Facet>& facets,
                                   const std::vector<uint32_t>& partners) {
  std::vector<uint32_t> shared;
  ForEachEdge(SortedHalfEdges(facets), [&](auto first, auto last) {
    if (last - first == 1 ||
        (last - first == 2 && FromVertex(facets, first->second) !=
                                  FromVertex(facets, (first + 1)->second))) {
      return;
    }
    const uint32_t kept = first->second;
    for (auto half = first + 1; half != last; ++half) {
      const uint32_t partner = partners[half->second];
      if (partner != kept &&
          (partner == kNoPartner || half->second < partner)) {
        shared.push_back(half->second);
      }
    }
  });
  return shared;
}

}  // namespace

FanSplit SplitFans(const TriangleMesh& mesh,
                   const std::vector<uint32_t>& partners) {
  FanSplit split;
  CopyVerticesPerFan(mesh, partners, &split);
  split.facet_sources.resize(mesh.facets.size());
  std::iota(split.facet_sources.begin(), split.facet_sources.end(), 0);
  std::vector<uint32_t> pairs = partners;
  std::vector<uint32_t> shared = SharedSheets(split.mesh.facets, pairs);
  while (!shared.empty()) {
    // A facet is cut once a round: its other half-edges are not what they were.
    std::unordered_set<uint32_t> cut_facets;
    for (const uint32_t half : shared) {
      const uint32_t other = pairs[half] == kNoPartner ? half : pairs[half];
      if (!cut_facets.contains(half / 3) && !cut_facets.contains(other / 3)) {
        cut_facets.insert({half / 3, other / 3});
        SubdivideEdge(half, &split, &pairs);
      }
    }
    shared = SharedSheets(split.mesh.facets, pairs);
  }
  return split;
}

void OrderByUse(FanSplit* split) {
  if (split->num_midpoints == 0) {
    return;
  }
  const FanSplit old = std::exchange(*split, {});
  std::vector<uint32_t> order(old.mesh.facets.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(
      order, {}, [&](uint32_t facet) { return old.facet_sources[facet]; });
  std::vector<uint32_t> numbers(old.mesh.vertices.size(), UINT32_MAX);
  for (const uint32_t facet : order) {
    split->facet_sources.push_back(old.facet_sources[facet]);
    Facet& added = split->mesh.facets.emplace_back(old.mesh.facets[facet]);
    for (uint32_t& vertex : added) {
      uint32_t& number = numbers[vertex];
      if (number == UINT32_MAX) {
        number = static_cast<uint32_t>(split->mesh.vertices.size());
        split->mesh.vertices.push_back(old.mesh.vertices[vertex]);
        split->sources.push_back(old.sources[vertex]);
      }
      vertex = number;
    }
  }
  split->num_split_vertices = old.num_split_vertices;
  split->num_midpoints = old.num_midpoints;
}

void CountPart(const std::vector<uint8_t>& is_of_part, FanSplit* split) {
  split->num_split_vertices = 0;
  split->num_midpoints = 0;
  uint32_t num_old = 0;
  for (const auto& source : split->sources) {
    num_old = std::max(num_old, source[0] + 1);
  }
  std::vector<uint8_t> is_found(num_old, 0);
  uint32_t next = 0;
  for (size_t i = 0; i < split->mesh.facets.size(); ++i) {
    const bool counts = is_of_part[split->facet_sources[i]] != 0;
    for (const uint32_t vertex : split->mesh.facets[i]) {
      if (vertex != next) {
        continue;  // it was used before
      }
      ++next;
      const auto& [a, b] = split->sources[vertex];
      if (a != b) {
        split->num_midpoints += counts;
      } else {
        split->num_split_vertices += counts && is_found[a] != 0;
        is_found[a] = 1;
      }
    }
  }
}

}  // namespace colmap_ext
