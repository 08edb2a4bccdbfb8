#include "mesh/fan_split.h"

#include <unordered_set>

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
  const uint32_t second = CutFacet(half, middle, &mesh.facets, partners);
  if (partner != kNoPartner) {
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

}  // namespace colmap_ext
