#include "mesh/fan_split.h"

#include <algorithm>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "mesh/half_edges.h"

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
  split->sources.reserve(positions.size());
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
    split->sources.push_back({source, source});
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
  partners->insert(partners->end(), {kNone, (*partners)[old_next], old_next});
  if ((*partners)[old_next] != kNone) {
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
  const auto source_of = [&](uint32_t facet) {
    const size_t num_old = mesh.facets.size() - split->cut_facets.size();
    return facet < num_old ? facet : split->cut_facets[facet - num_old];
  };
  const uint32_t source = source_of(half / 3);
  const uint32_t second = CutFacet(half, middle, &mesh.facets, partners);
  split->cut_facets.push_back(source);
  if (partner != kNone) {
    const uint32_t other_source = source_of(partner / 3);
    const uint32_t partner_second =
        CutFacet(partner, middle, &mesh.facets, partners);
    split->cut_facets.push_back(other_source);
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
  ForEachEdge(facets, [&](auto first, auto last) {
    if (last - first == 1 ||
        (last - first == 2 && FromVertex(facets, first->second) !=
                                  FromVertex(facets, (first + 1)->second))) {
      return;
    }
    const uint32_t kept = first->second;
    for (auto half = first + 1; half != last; ++half) {
      const uint32_t partner = partners[half->second];
      if (partner != kept && (partner == kNone || half->second < partner)) {
        shared.push_back(half->second);
      }
    }
  });
  return shared;
}

}  // namespace

FanSplit SplitFans(TriangleMesh mesh, std::vector<uint32_t> partners) {
  FanSplit split;
  split.mesh = std::move(mesh);
  CopyVerticesPerFan(partners, &split);
  std::vector<uint32_t> shared = SharedSheets(split.mesh.facets, partners);
  while (!shared.empty()) {
    // A facet is cut once a round: its other half-edges are not what they were.
    std::unordered_set<uint32_t> cut_facets;
    for (const uint32_t half : shared) {
      const uint32_t partner = partners[half];
      const uint32_t other = partner == kNone ? half : partner;
      if (!cut_facets.contains(half / 3) && !cut_facets.contains(other / 3)) {
        cut_facets.insert({half / 3, other / 3});
        SubdivideEdge(half, &split, &partners);
      }
    }
    shared = SharedSheets(split.mesh.facets, partners);
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
  const size_t num_old = order.size() - old.cut_facets.size();
  std::ranges::stable_sort(order, {}, [&](uint32_t facet) {
    return facet < num_old ? facet : old.cut_facets[facet - num_old];
  });
  std::vector<uint32_t> numbers(old.mesh.vertices.size(), kNone);
  for (const uint32_t facet : order) {
    Facet& added = split->mesh.facets.emplace_back(old.mesh.facets[facet]);
    for (uint32_t& vertex : added) {
      uint32_t& number = numbers[vertex];
      if (number == kNone) {
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

}  // namespace colmap_ext
