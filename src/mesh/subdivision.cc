#include "mesh/subdivision.h"

#include <algorithm>
#include <cassert>
#include <tuple>

#include <tbb/parallel_for.h>

#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

double LengthSquared(const TriangleMesh& mesh, uint32_t a, uint32_t b) {
  return (mesh.vertices[a].cast<double>() - mesh.vertices[b].cast<double>())
      .squaredNorm();
}

// The half-edge along a facet's longest edge; of equally long ones the edge
// with the highest vertices.
uint32_t LongestHalfEdge(const TriangleMesh& mesh, uint32_t facet) {
  const auto rank = [&](uint32_t half) {
    const auto [low, high] = std::minmax(
        {FromVertex(mesh.facets, half), ToVertex(mesh.facets, half)});
    return std::tuple(LengthSquared(mesh, low, high), low, high);
  };
  return std::max({3 * facet, 3 * facet + 1, 3 * facet + 2},
                  [&](uint32_t a, uint32_t b) { return rank(a) < rank(b); });
}

// [3 F] whether a half-edge gets a midpoint. The set is the closure of the
// given edges under "a cut facet is cut at its longest edge", hence independent
// of the order; fixed edges are never cut.
// \param partners [3 F]
std::vector<uint8_t> ChooseCutEdges(const TriangleMesh& mesh,
                                    const std::vector<uint32_t>& partners,
                                    const std::vector<uint8_t>& is_to_split,
                                    const FixedVertices& fixed) {
  std::vector<uint8_t> is_cut(partners.size(), 0);
  std::vector<uint32_t> touched;  // facets
  const auto cut = [&](uint32_t half) {
    const bool is_fixed = IsFixed(fixed, FromVertex(mesh.facets, half)) &&
                          IsFixed(fixed, ToVertex(mesh.facets, half));
    if (!is_cut[half] && !is_fixed) {
      for (const uint32_t side : {half, partners[half]}) {
        if (side != kNone) {
          is_cut[side] = 1;
          touched.push_back(side / 3);
        }
      }
    }
  };
  for (uint32_t half = 0; half < partners.size(); ++half) {
    if (is_to_split[half / 3]) {
      cut(half);
    }
  }
  while (!touched.empty()) {
    const uint32_t facet = touched.back();
    touched.pop_back();
    cut(LongestHalfEdge(mesh, facet));
  }
  return is_cut;
}

// Numbers the midpoints and appends them.
// \return [3 F] the midpoint's vertex, or kNone
std::vector<uint32_t> AppendMidpoints(const std::vector<Facet>& facets,
                                      const std::vector<uint32_t>& partners,
                                      const std::vector<uint8_t>& is_cut,
                                      DerivedMesh* result) {
  std::vector<uint32_t> midpoints(partners.size(), kNone);
  std::vector<Eigen::Vector3f>& vertices = result->mesh.vertices;
  for (uint32_t half = 0; half < partners.size(); ++half) {
    if (is_cut[half] && midpoints[half] == kNone) {
      const uint32_t from = FromVertex(facets, half);
      const uint32_t to = ToVertex(facets, half);
      midpoints[half] = static_cast<uint32_t>(vertices.size());
      if (partners[half] != kNone) {
        midpoints[partners[half]] = midpoints[half];
      }
      vertices.emplace_back(0.5f * (vertices[from] + vertices[to]));
      result->from.vertices.push_back({std::min(from, to), std::max(from, to)});
    }
  }
  return midpoints;
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
  const auto num_cut = 3 - std::ranges::count(middles, kNone);
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
    parts[0] = {a, middles[k], c};
    parts[1] = {middles[k], b, c};
  } else {
    CutInThree(mesh, a, b, c, middles[k], middles[(k + 1) % 3], parts);
  }
}

}  // namespace

DerivedMesh Subdivide(const TriangleMesh& mesh,
                      const std::vector<uint8_t>& is_to_split,
                      const FixedVertices& fixed) {
  assert(is_to_split.size() == mesh.facets.size());
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  const std::vector<uint8_t> is_cut =
      ChooseCutEdges(mesh, partners, is_to_split, fixed);
  DerivedMesh result{{mesh.vertices, {}}, {}};
  result.from = IdentityOf(result.mesh);
  const std::vector<uint32_t> midpoints =
      AppendMidpoints(mesh.facets, partners, is_cut, &result);
  std::vector<size_t> first_part(mesh.facets.size());
  for (uint32_t facet = 0; facet < first_part.size(); ++facet) {
    first_part[facet] = result.from.facets.size();
    const size_t num_parts =
        1 + is_cut[3 * facet] + is_cut[3 * facet + 1] + is_cut[3 * facet + 2];
    result.from.facets.insert(result.from.facets.end(), num_parts, facet);
  }
  result.mesh.facets.resize(result.from.facets.size());
  tbb::parallel_for(size_t{0}, first_part.size(), [&](size_t facet) {
    CutFacet(result.mesh, mesh.facets[facet],
             {midpoints[3 * facet], midpoints[3 * facet + 1],
              midpoints[3 * facet + 2]},
             &result.mesh.facets[first_part[facet]]);
  });
  return result;
}

}  // namespace colmap_ext
