#include "mesh/subdivision.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/index_limit.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

// The edges of facets, and the half-edges along each.
struct Edges {
  explicit Edges(const std::vector<Facet>& facets)
      : edge_of_half(3 * facets.size()) {
    halves.reserve(edge_of_half.size());
    ForEachEdge(facets, [&](auto first, auto last) {
      for (auto half = first; half != last; ++half) {
        edge_of_half[half->second] = static_cast<uint32_t>(offsets.size() - 1);
        halves.push_back(half->second);
      }
      offsets.push_back(static_cast<uint32_t>(halves.size()));
    });
  }

  size_t size() const { return offsets.size() - 1; }

  std::vector<uint32_t> offsets{0};    // [E + 1], into halves
  std::vector<uint32_t> halves;        // [3 F] of one edge after the other
  std::vector<uint32_t> edge_of_half;  // [3 F]
};

double LengthSquared(const TriangleMesh& mesh, uint32_t a, uint32_t b) {
  return (mesh.vertices[a].cast<double>() - mesh.vertices[b].cast<double>())
      .squaredNorm();
}

double LengthSquared(const TriangleMesh& mesh, uint32_t half) {
  return LengthSquared(mesh, FromVertex(mesh.facets, half),
                       ToVertex(mesh.facets, half));
}

// The half-edge along a facet's longest edge; of equally long ones the edge
// with the highest index.
uint32_t LongestHalfEdge(const TriangleMesh& mesh, const Edges& edges,
                         uint32_t facet) {
  uint32_t longest = 3 * facet;
  for (uint32_t half = 3 * facet + 1; half < 3 * facet + 3; ++half) {
    const double length = LengthSquared(mesh, half);
    const double before = LengthSquared(mesh, longest);
    if (length > before ||
        (length == before &&
         edges.edge_of_half[half] > edges.edge_of_half[longest])) {
      longest = half;
    }
  }
  return longest;
}

// [E] whether an edge gets a midpoint. The set is the closure of the given
// edges under "a cut facet is cut at its longest edge", hence independent of
// the order; edges that stay are never cut.
std::vector<uint8_t> ChooseCutEdges(const TriangleMesh& mesh,
                                    const Edges& edges,
                                    const std::vector<uint8_t>& is_to_split,
                                    const FixedVertices& fixed) {
  std::vector<uint8_t> is_cut(edges.size(), 0);
  std::vector<uint32_t> touched;  // facets
  const auto cut = [&](uint32_t half) {
    const uint32_t edge = edges.edge_of_half[half];
    const bool is_fixed = IsFixed(fixed, FromVertex(mesh.facets, half)) &&
                          IsFixed(fixed, ToVertex(mesh.facets, half));
    if (!is_cut[edge] && !is_fixed) {
      is_cut[edge] = 1;
      for (uint32_t i = edges.offsets[edge]; i < edges.offsets[edge + 1]; ++i) {
        touched.push_back(edges.halves[i] / 3);
      }
    }
  };
  for (uint32_t half = 0; half < 3 * mesh.facets.size(); ++half) {
    if (is_to_split[half / 3]) {
      cut(half);
    }
  }
  while (!touched.empty()) {
    const uint32_t facet = touched.back();
    touched.pop_back();
    cut(LongestHalfEdge(mesh, edges, facet));
  }
  return is_cut;
}

// Numbers the midpoints and appends them.
// \return [E] the midpoint's vertex, or kNone
std::vector<uint32_t> AppendMidpoints(const std::vector<Facet>& facets,
                                      const Edges& edges,
                                      const std::vector<uint8_t>& is_cut,
                                      Subdivision* result) {
  std::vector<uint32_t> midpoints(edges.size(), kNone);
  std::vector<Eigen::Vector3f>& vertices = result->mesh.vertices;
  for (uint32_t half = 0; half < 3 * facets.size(); ++half) {
    const uint32_t edge = edges.edge_of_half[half];
    if (is_cut[edge] && midpoints[edge] == kNone) {
      const uint32_t from = FromVertex(facets, half);
      const uint32_t to = ToVertex(facets, half);
      midpoints[edge] = static_cast<uint32_t>(vertices.size());
      vertices.emplace_back(0.5f * (vertices[from] + vertices[to]));
      result->sources.push_back({std::min(from, to), std::max(from, to)});
    }
  }
  return midpoints;
}

// The parts of a facet abc that is cut at ab.
void CutInTwo(uint32_t a, uint32_t b, uint32_t c, uint32_t ab, Facet* parts) {
  parts[0] = {a, ab, c};
  parts[1] = {ab, b, c};
}

// The parts of a facet abc that is cut at ab and bc.
void CutInThree(const TriangleMesh& mesh, uint32_t a, uint32_t b, uint32_t c,
                uint32_t ab, uint32_t bc, Facet* parts) {
  const double from_a = LengthSquared(mesh, a, bc);
  const double from_c = LengthSquared(mesh, ab, c);
  parts[0] = {ab, b, bc};
  if (from_a < from_c || (from_a == from_c && a < c)) {
    parts[1] = {a, ab, bc};
    parts[2] = {a, bc, c};
  } else {
    parts[1] = {a, ab, c};
    parts[2] = {ab, bc, c};
  }
}

// \param mesh  with the midpoints
// \param middles  of the facet's half-edges, or kNone
void CutFacet(const TriangleMesh& mesh, const Facet& facet,
              const std::array<uint32_t, 3>& middles, Facet* parts) {
  int num_cut = 0;
  for (const uint32_t middle : middles) {
    num_cut += middle != kNone;
  }
  if (num_cut == 0) {
    parts[0] = facet;
    return;
  }
  if (num_cut == 3) {
    parts[0] = {facet[0], middles[0], middles[2]};
    parts[1] = {middles[0], facet[1], middles[1]};
    parts[2] = {middles[2], middles[1], facet[2]};
    parts[3] = {middles[0], middles[1], middles[2]};
    return;
  }
  // Starting where a cut half-edge follows one that is not.
  int k = 0;
  while (middles[k] == kNone || middles[(k + 2) % 3] != kNone) {
    ++k;
  }
  const uint32_t a = facet[k];
  const uint32_t b = facet[(k + 1) % 3];
  const uint32_t c = facet[(k + 2) % 3];
  if (num_cut == 1) {
    CutInTwo(a, b, c, middles[k], parts);
  } else {
    CutInThree(mesh, a, b, c, middles[k], middles[(k + 1) % 3], parts);
  }
}

}  // namespace

Subdivision Subdivide(const TriangleMesh& mesh,
                      const std::vector<uint8_t>& is_to_split,
                      const FixedVertices& fixed) {
  assert(is_to_split.size() == mesh.facets.size());
  const auto num_facets = static_cast<uint32_t>(mesh.facets.size());
  const Edges edges(mesh.facets);
  const std::vector<uint8_t> is_cut =
      ChooseCutEdges(mesh, edges, is_to_split, fixed);
  Subdivision result;
  result.mesh.vertices = mesh.vertices;
  for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    result.sources.push_back({vertex, vertex});
  }
  const std::vector<uint32_t> midpoints =
      AppendMidpoints(mesh.facets, edges, is_cut, &result);
  const auto middle = [&](uint32_t facet, int k) {
    return midpoints[edges.edge_of_half[3 * facet + k]];
  };
  std::vector<size_t> first_part(num_facets);
  for (uint32_t facet = 0; facet < num_facets; ++facet) {
    first_part[facet] = result.facet_sources.size();
    const size_t num_parts = 1 + (middle(facet, 0) != kNone) +
                             (middle(facet, 1) != kNone) +
                             (middle(facet, 2) != kNone);
    result.facet_sources.insert(result.facet_sources.end(), num_parts, facet);
  }
  result.mesh.facets.resize(result.facet_sources.size());
  tbb::parallel_for(uint32_t{0}, num_facets, [&](uint32_t facet) {
    CutFacet(result.mesh, mesh.facets[facet],
             {middle(facet, 0), middle(facet, 1), middle(facet, 2)},
             &result.mesh.facets[first_part[facet]]);
  });
  return result;
}

}  // namespace colmap_ext
