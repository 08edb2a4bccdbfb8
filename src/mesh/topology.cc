#include "mesh/topology.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

// Facets that can be looked at further: indices in range, no vertex twice.
std::vector<Facet> ValidFacets(const TriangleMesh& mesh, MeshReport* report) {
  std::vector<Facet> valid;
  valid.reserve(mesh.facets.size());
  for (const Facet& facet : mesh.facets) {
    if (*std::max_element(facet.begin(), facet.end()) >= mesh.vertices.size()) {
      ++report->num_invalid_facets;
    } else if (facet[0] == facet[1] || facet[1] == facet[2] ||
               facet[2] == facet[0]) {
      ++report->num_degenerate_facets;
    } else {
      valid.push_back(facet);
    }
  }
  return valid;
}

size_t CountDuplicates(std::vector<Facet> facets) {
  for (Facet& facet : facets) {
    std::sort(facet.begin(), facet.end());
  }
  std::sort(facets.begin(), facets.end());
  size_t count = 0;
  for (size_t i = 1; i < facets.size(); ++i) {
    count += facets[i] == facets[i - 1];
  }
  return count;
}

// Joins what the edges connect and counts them.
struct EdgeWalk {
  UnionFind fans;        // of corners, around their vertices
  UnionFind components;  // of facets
  UnionFind loops;       // of vertices, along the border
  std::vector<uint8_t> on_border;
  std::vector<uint8_t> on_non_manifold_edge;
};

EdgeWalk WalkEdges(const std::vector<Facet>& facets, size_t num_vertices,
                   MeshReport* report) {
  EdgeWalk walk{UnionFind(3 * facets.size()), UnionFind(facets.size()),
                UnionFind(num_vertices), std::vector<uint8_t>(num_vertices, 0),
                std::vector<uint8_t>(num_vertices, 0)};
  // The corner of a half-edge's facet at one of its ends.
  const auto corner = [&](uint32_t half, uint32_t vertex) -> uint32_t {
    const bool at_start = FromVertex(facets, half) == vertex;
    return at_start ? half : half / 3 * 3 + (half % 3 + 1) % 3;
  };
  ForEachEdge(SortedHalfEdges(facets), [&](auto first, auto last) {
    ++report->num_edges;
    const uint32_t u = FromVertex(facets, first->second);
    const uint32_t v = ToVertex(facets, first->second);
    size_t forward = 0;
    for (auto half = first; half != last; ++half) {
      forward += FromVertex(facets, half->second) == u;
      walk.fans.Join(corner(first->second, u), corner(half->second, u));
      walk.fans.Join(corner(first->second, v), corner(half->second, v));
      walk.components.Join(first->second / 3, half->second / 3);
    }
    const auto num_facets = static_cast<size_t>(last - first);
    if (num_facets == 1) {
      ++report->num_border_edges;
      walk.on_border[u] = walk.on_border[v] = 1;
      walk.loops.Join(u, v);
    }
    if (num_facets > 2) {
      ++report->num_non_manifold_edges;
      walk.on_non_manifold_edge[u] = walk.on_non_manifold_edge[v] = 1;
    }
    report->num_misoriented_edges += forward > 1 || num_facets - forward > 1;
  });
  return walk;
}

// A vertex is singular where its facets form more than one fan, or more than
// two of them share one of its edges.
void CountVertices(const TriangleMesh& mesh, const std::vector<Facet>& facets,
                   EdgeWalk* walk, MeshReport* report) {
  std::vector<uint32_t> num_fans(mesh.vertices.size(), 0);
  std::vector<uint8_t> is_used(mesh.vertices.size(), 0);
  for (uint32_t corner = 0; corner < 3 * facets.size(); ++corner) {
    const uint32_t vertex = FromVertex(facets, corner);
    is_used[vertex] = 1;
    num_fans[vertex] += walk->fans.Find(corner) == corner;
  }
  for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    report->num_non_finite_vertices += !mesh.vertices[vertex].allFinite();
    report->num_unreferenced_vertices += !is_used[vertex];
    report->num_singular_vertices +=
        num_fans[vertex] > 1 || walk->on_non_manifold_edge[vertex];
    report->num_border_loops +=
        walk->on_border[vertex] && walk->loops.Find(vertex) == vertex;
  }
}

}  // namespace

bool MeshReport::IsManifold() const { return Defects().empty(); }

std::string MeshReport::Defects() const {
  const std::pair<size_t, const char*> defects[] = {
      {num_non_finite_vertices, "vertices that are not finite"},
      {num_unreferenced_vertices, "vertices without a facet"},
      {num_invalid_facets, "facets with an index out of range"},
      {num_degenerate_facets, "facets that repeat a vertex"},
      {num_duplicate_facets, "facets that are there twice"},
      {num_non_manifold_edges, "edges with more than two facets"},
      {num_misoriented_edges, "edges run twice in one direction"},
      {num_singular_vertices, "singular vertices"}};
  std::string text;
  for (const auto& [count, name] : defects) {
    if (count > 0) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
  }
  return text;
}

void MeshReport::DeriveGenus() {
  euler = static_cast<int64_t>(num_vertices) - static_cast<int64_t>(num_edges) +
          static_cast<int64_t>(num_facets);
  genus = (2 * static_cast<int64_t>(num_components) - euler -
           static_cast<int64_t>(num_border_loops)) /
          2;
}

MeshReport Analyze(const TriangleMesh& mesh) {
  MeshReport report;
  report.num_vertices = mesh.vertices.size();
  report.num_facets = mesh.facets.size();
  const std::vector<Facet> facets = ValidFacets(mesh, &report);
  report.num_duplicate_facets = CountDuplicates(facets);
  EdgeWalk walk = WalkEdges(facets, mesh.vertices.size(), &report);
  for (uint32_t facet = 0; facet < facets.size(); ++facet) {
    report.num_components += walk.components.Find(facet) == facet;
  }
  CountVertices(mesh, facets, &walk, &report);
  report.DeriveGenus();
  return report;
}

}  // namespace colmap_ext
