#include "mesh/topology.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

// For several threads.
template <typename T>
void Add(T number, size_t* count) {
  if (number != 0) {
    std::atomic_ref(*count).fetch_add(static_cast<size_t>(number),
                                      std::memory_order_relaxed);
  }
}

class Analyzer {
 public:
  // \pre facets are valid
  Analyzer(const std::vector<Facet>& facets, size_t num_vertices,
           MeshReport* report)
      : facets_(facets),
        report_(*report),
        components_(facets.size()),
        loops_(num_vertices) {}

  void Run() {
    // Of those there may be, joins take away.
    report_.num_components = facets_.size();
    report_.num_unreferenced_vertices = report_.num_vertices;
    ForEachVertex<true>(
        facets_, [&](uint32_t vertex, const std::vector<HalfEdgeTo>& halves) {
          bool is_singular = !IsOneFan(vertex, halves);
          bool is_at_border = false;
          size_t num_edges = 0;
          ForEachNeighbor(halves, [&](auto first, auto last) {
            is_singular |= last - first > 2;
            is_at_border |= last - first == 1;
            if (first->first > vertex) {
              ++num_edges;
              CountEdge(vertex, first, last);
            }
          });
          Add(num_edges, &report_.num_edges);
          Add(is_singular, &report_.num_singular_vertices);
          Add(is_at_border, &report_.num_border_loops);
          Add(halves.empty() ? 0 : -1, &report_.num_unreferenced_vertices);
        });
  }

 private:
  // Whether edges connect all facets at a vertex.
  bool IsOneFan(uint32_t vertex, const std::vector<HalfEdgeTo>& halves) const {
    std::vector<uint32_t> neighbors;  // ascending
    ForEachNeighbor(halves, [&](auto first, auto /*last*/) {
      neighbors.push_back(first->first);
    });
    size_t num_fans = neighbors.size();
    UnionFind fans(num_fans);
    for (const auto& [other, half] : halves) {
      if (FromVertex(facets_, half) == vertex) {
        const uint32_t third = FromVertex(facets_, PreviousHalfEdge(half));
        num_fans -=
            fans.Join(IndexOf(neighbors, other), IndexOf(neighbors, third));
      }
    }
    return num_fans <= 1;
  }

  // \param first, last  half-edges between a vertex and a higher one
  template <typename Iterator>
  void CountEdge(uint32_t vertex, Iterator first, Iterator last) {
    size_t forward = 0;
    std::vector<uint32_t> apexes;
    for (auto half = first; half != last; ++half) {
      forward += FromVertex(facets_, half->second) == vertex;
      const bool joins = components_.Join(first->second / 3, half->second / 3);
      Add(joins ? -1 : 0, &report_.num_components);
      const uint32_t apex = FromVertex(facets_, PreviousHalfEdge(half->second));
      // A facet is looked at once, along its first edge.
      if (apex > first->first) {
        apexes.push_back(apex);
      }
    }
    std::ranges::sort(apexes);
    Add(apexes.end() - std::unique(apexes.begin(), apexes.end()),
        &report_.num_duplicate_facets);
    const auto num_facets = static_cast<size_t>(last - first);
    if (num_facets == 1) {
      Add(1, &report_.num_border_edges);
      Add(loops_.Join(vertex, first->first) ? -1 : 0,
          &report_.num_border_loops);
    }
    Add(num_facets > 2, &report_.num_non_manifold_edges);
    Add(forward > 1 || num_facets - forward > 1,
        &report_.num_misoriented_edges);
  }

  const std::vector<Facet>& facets_;
  MeshReport& report_;
  UnionFind components_;  // of facets
  UnionFind loops_;       // of vertices, along the border
};

}  // namespace

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

MeshReport Analyze(const TriangleMesh& mesh) {
  MeshReport report;
  report.num_vertices = mesh.vertices.size();
  report.num_facets = mesh.facets.size();
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    report.num_non_finite_vertices += !vertex.allFinite();
  }
  std::vector<Facet> valid = mesh.facets;
  report.num_invalid_facets = std::erase_if(valid, [&](const Facet& facet) {
    return std::ranges::max(facet) >= mesh.vertices.size();
  });
  report.num_degenerate_facets = std::erase_if(valid, RepeatsVertex);
  Analyzer(valid, mesh.vertices.size(), &report).Run();
  // Differences of counts may be negative.
  report.euler = static_cast<int64_t>(report.num_vertices + report.num_facets -
                                      report.num_edges);
  report.genus = (static_cast<int64_t>(2 * report.num_components -
                                       report.num_border_loops) -
                  report.euler) /
                 2;
  return report;
}

}  // namespace colmap_ext
