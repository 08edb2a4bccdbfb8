#include "repair/edit_borders.h"

#include <algorithm>
#include <utility>

#include "base/index_limit.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/manifold_repair.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

// A mesh with what finds its facets' neighbors.
struct LinkedMesh {
  const TriangleMesh& mesh;
  VertexRings rings;
  std::vector<uint32_t> partners;  // [3 F]
};

double Area(const TriangleMesh& mesh, const std::vector<uint32_t>& facets) {
  double sum = 0;
  for (const uint32_t facet : facets) {
    sum += AreaVector(mesh, mesh.facets[facet]).norm() / 2;
  }
  return sum;
}

// Joins facets of the same mark that share an edge.
// \param marks [F]
UnionFind JoinFacets(const LinkedMesh& surface,
                     const std::vector<uint8_t>& marks) {
  UnionFind pieces(surface.mesh.facets.size());
  for (uint32_t half = 0; half < surface.partners.size(); ++half) {
    const uint32_t partner = surface.partners[half];
    if (partner != kNone && partner < half &&
        marks[half / 3] == marks[partner / 3]) {
      pieces.Join(half / 3, partner / 3);
    }
  }
  return pieces;
}

// The area of the confident facets within so many rings of a region.
// \param facets  of the region
double AreaAround(const LinkedMesh& surface, const std::vector<uint8_t>& is_low,
                  const std::vector<uint32_t>& facets, int num_rings) {
  std::vector<uint32_t> vertices = VerticesOf(surface.mesh, facets);
  std::vector<uint32_t> around;
  for (int ring = 0; ring < num_rings; ++ring) {
    around = surface.rings.FacetsAt(vertices);
    std::erase_if(around, [&](uint32_t i) { return is_low[i] != 0; });
    const std::vector<uint32_t> next = VerticesOf(surface.mesh, around);
    vertices.insert(vertices.end(), next.begin(), next.end());
  }
  return Area(surface.mesh, around);
}

// Which facets are dropped: [F] those of regions that are more than a gap.
std::vector<uint8_t> FindRegions(const LinkedMesh& surface,
                                 const std::vector<uint8_t>& is_low,
                                 int num_rings, TrimReport* report) {
  UnionFind pieces = JoinFacets(surface, is_low);
  std::vector<std::vector<uint32_t>> facets(is_low.size());  // of each region
  std::vector<uint8_t> has_border(is_low.size(), 0);
  for (uint32_t i = 0; i < is_low.size(); ++i) {
    if (is_low[i] != 0) {
      const uint32_t region = pieces.Find(i);
      facets[region].push_back(i);
      for (uint32_t half = 3 * i; half < 3 * i + 3; ++half) {
        has_border[region] |= surface.partners[half] == kNone;
      }
    }
  }
  std::vector<uint8_t> is_dropped(is_low.size(), 0);
  report->num_kept_facets = 0;
  for (uint32_t region = 0; region < facets.size(); ++region) {
    if (facets[region].empty()) {
      continue;
    }
    if (has_border[region] == 0 &&
        Area(surface.mesh, facets[region]) <=
            AreaAround(surface, is_low, facets[region], num_rings)) {
      report->num_kept_facets += facets[region].size();
      continue;
    }
    ++report->num_regions;
    report->num_facets += facets[region].size();
    for (const uint32_t facet : facets[region]) {
      is_dropped[facet] = 1;
    }
  }
  return is_dropped;
}

// The vertices of a piece, by where they lie.
struct PieceVertices {
  size_t num_inside = 0;
  size_t num_border = 0;
  bool is_cut = false;  // from a dropped facet
};

// [F] by the pieces' representatives.
std::vector<PieceVertices> CountVertices(const LinkedMesh& surface,
                                         const std::vector<uint8_t>& is_dropped,
                                         UnionFind* pieces) {
  std::vector<PieceVertices> counts(is_dropped.size());
  std::vector<uint8_t> is_border(is_dropped.size() * 3, 0);  // of half-edges
  for (uint32_t half = 0; half < is_border.size(); ++half) {
    const uint32_t partner = surface.partners[half];
    const bool is_cut = partner != kNone && is_dropped[partner / 3] != 0;
    is_border[half] = partner == kNone || is_cut;
    counts[pieces->Find(half / 3)].is_cut |= is_cut;
  }
  std::vector<std::pair<uint32_t, uint8_t>> at_vertex;  // piece, whether border
  for (size_t vertex = 0; vertex < surface.rings.NumVertices(); ++vertex) {
    at_vertex.clear();
    for (const uint32_t corner : surface.rings.corners[vertex]) {
      const uint32_t previous = NextHalfEdge(NextHalfEdge(corner));
      at_vertex.emplace_back(pieces->Find(corner / 3),
                             is_border[corner] | is_border[previous]);
    }
    std::sort(at_vertex.begin(), at_vertex.end());
    for (size_t i = 0; i < at_vertex.size(); ++i) {
      // The last one of a piece says whether any of its facets is at a border.
      if (i + 1 == at_vertex.size() ||
          at_vertex[i].first != at_vertex[i + 1].first) {
        PieceVertices& count = counts[at_vertex[i].first];
        ++(at_vertex[i].second != 0 ? count.num_border : count.num_inside);
      }
    }
  }
  return counts;
}

// Drops the pieces of what is left that are next to nothing but border.
void AddLeftovers(const LinkedMesh& surface, std::vector<uint8_t>* is_dropped,
                  TrimReport* report) {
  UnionFind pieces = JoinFacets(surface, *is_dropped);
  const std::vector<PieceVertices> counts =
      CountVertices(surface, *is_dropped, &pieces);
  for (uint32_t i = 0; i < is_dropped->size(); ++i) {
    const uint32_t piece = pieces.Find(i);
    const PieceVertices& count = counts[piece];
    if ((*is_dropped)[i] == 0 && count.is_cut &&
        count.num_inside <= count.num_border) {
      report->num_leftovers += piece == i;
      ++report->num_leftover_facets;
      (*is_dropped)[i] = 1;
    }
  }
}

// Drops the facets and smooths the borders that this opens.
void Drop(const LinkedMesh& surface, const std::vector<uint8_t>& is_dropped,
          TrimmedMesh* trimmed) {
  TriangleMesh kept{surface.mesh.vertices, {}};
  std::vector<uint32_t> sources;   // [F]
  std::vector<uint8_t> is_opened;  // [3 F]
  for (uint32_t i = 0; i < is_dropped.size(); ++i) {
    if (is_dropped[i] != 0) {
      continue;
    }
    kept.facets.push_back(surface.mesh.facets[i]);
    sources.push_back(trimmed->from.facets[i]);
    for (uint32_t half = 3 * i; half < 3 * i + 3; ++half) {
      const uint32_t partner = surface.partners[half];
      is_opened.push_back(partner != kNone && is_dropped[partner / 3] != 0);
    }
  }
  // A manifold mesh gets no midpoints: facets and half-edges keep their
  // indices.
  FanSplit split = SplitFans(std::move(kept));
  SmoothBorders(is_opened, &split.mesh);
  trimmed->mesh = std::move(split.mesh);
  trimmed->from.facets = std::move(sources);
  trimmed->from = Compose(trimmed->from, std::move(split.from));
}

// \return whether anything was dropped
bool TrimOnce(double min_confidence, int num_rings,
              const std::vector<float>& facet_confidences,
              TrimmedMesh* trimmed) {
  const TriangleMesh& mesh = trimmed->mesh;
  const LinkedMesh surface{mesh, MakeVertexRings(mesh),
                           PairHalfEdges(mesh.facets)};
  std::vector<uint8_t> is_low(mesh.facets.size());
  for (size_t i = 0; i < is_low.size(); ++i) {
    is_low[i] = facet_confidences[trimmed->from.facets[i]] < min_confidence;
  }
  std::vector<uint8_t> is_dropped =
      FindRegions(surface, is_low, num_rings, &trimmed->report);
  if (std::ranges::find(is_dropped, 1) == is_dropped.end()) {
    return false;
  }
  AddLeftovers(surface, &is_dropped, &trimmed->report);
  Drop(surface, is_dropped, trimmed);
  return true;
}

}  // namespace

TrimmedMesh TrimMesh(double min_confidence, TriangleMesh mesh,
                     const std::vector<float>& facet_confidences,
                     int num_rings) {
  TrimmedMesh trimmed;
  trimmed.from = IdentityOf(mesh);
  trimmed.mesh = std::move(mesh);
  while (min_confidence > 0 &&
         TrimOnce(min_confidence, num_rings, facet_confidences, &trimmed)) {
  }
  return trimmed;
}

}  // namespace colmap_ext
