#include "mesh/topology.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

bool HasInvalidIndex(const TriangleMesh& mesh, const Facet& facet) {
  return std::ranges::max(facet) >= mesh.vertices.size();
}

class Analyzer {
 public:
  // \pre facets are valid
  Analyzer(const std::vector<Facet>& facets, size_t num_vertices,
           MeshReport* report)
      : facets_(facets),
        report_(*report),
        components_(facets.size()),
        loops_(num_vertices),
        is_at_border_(num_vertices, false) {}

  void Run() {
    size_t num_used = 0;
    ForEachVertex(facets_,
                  [&](uint32_t vertex, const std::vector<HalfEdgeTo>& halves) {
                    num_used += halves.empty() ? 0 : 1;
                    bool is_singular = !IsOneFan(vertex, halves);
                    ForEachNeighbor(halves, [&](auto first, auto last) {
                      is_singular |= last - first > 2;
                      if (first->first > vertex) {
                        CountEdge(vertex, first, last);
                      }
                    });
                    report_.num_singular_vertices += is_singular ? 1 : 0;
                  });
    report_.num_unreferenced_vertices = is_at_border_.size() - num_used;
    for (uint32_t facet = 0; facet < facets_.size(); ++facet) {
      report_.num_components += components_.Find(facet) == facet;
    }
    for (uint32_t vertex = 0; vertex < is_at_border_.size(); ++vertex) {
      report_.num_border_loops +=
          is_at_border_[vertex] && loops_.Find(vertex) == vertex;
    }
  }

 private:
  // Whether edges connect all facets at a vertex.
  bool IsOneFan(uint32_t vertex, const std::vector<HalfEdgeTo>& halves) {
    fan_.clear();
    for (const auto& [other, half] : halves) {
      if (FromVertex(facets_, half) == vertex) {
        fan_.push_back(half / 3);
      }
    }
    std::ranges::sort(fan_);
    const auto place = [&](uint32_t half) { return IndexOf(fan_, half / 3); };
    UnionFind fans(fan_.size());
    ForEachNeighbor(halves, [&](auto first, auto last) {
      for (auto half = first; half != last; ++half) {
        fans.Join(place(first->second), place(half->second));
      }
    });
    size_t num_fans = 0;
    for (uint32_t i = 0; i < fan_.size(); ++i) {
      num_fans += fans.Find(i) == i;
    }
    return num_fans <= 1;
  }

  // \param first, last  half-edges between a vertex and a higher one
  template <typename Iterator>
  void CountEdge(uint32_t vertex, Iterator first, Iterator last) {
    ++report_.num_edges;
    size_t forward = 0;
    apexes_.clear();
    for (auto half = first; half != last; ++half) {
      forward += FromVertex(facets_, half->second) == vertex;
      components_.Join(first->second / 3, half->second / 3);
      const uint32_t apex = FromVertex(facets_, PreviousHalfEdge(half->second));
      // A facet is looked at once, along its first edge.
      if (apex > first->first) {
        apexes_.push_back(apex);
      }
    }
    std::ranges::sort(apexes_);
    report_.num_duplicate_facets += static_cast<size_t>(
        apexes_.end() - std::unique(apexes_.begin(), apexes_.end()));
    const auto num_facets = static_cast<size_t>(last - first);
    if (num_facets == 1) {
      ++report_.num_border_edges;
      is_at_border_[vertex] = is_at_border_[first->first] = true;
      loops_.Join(vertex, first->first);
    }
    report_.num_non_manifold_edges += num_facets > 2;
    report_.num_misoriented_edges += forward > 1 || num_facets - forward > 1;
  }

  const std::vector<Facet>& facets_;
  MeshReport& report_;
  UnionFind components_;            // of facets
  UnionFind loops_;                 // of vertices, along the border
  std::vector<bool> is_at_border_;  // [V]
  std::vector<uint32_t> fan_;       // facets at a vertex, ascending
  std::vector<uint32_t> apexes_;    // of facets at an edge
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
  std::vector<Facet> valid;  // where some are not
  for (const Facet& facet : mesh.facets) {
    const bool is_invalid = HasInvalidIndex(mesh, facet);
    report.num_invalid_facets += is_invalid;
    report.num_degenerate_facets += !is_invalid && RepeatsVertex(facet);
  }
  const bool are_valid =
      report.num_invalid_facets + report.num_degenerate_facets == 0;
  if (!are_valid) {
    std::ranges::copy_if(
        mesh.facets, std::back_inserter(valid), [&](const Facet& facet) {
          return !HasInvalidIndex(mesh, facet) && !RepeatsVertex(facet);
        });
  }
  Analyzer(are_valid ? mesh.facets : valid, mesh.vertices.size(), &report)
      .Run();
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
