#include "merging/sectioned_topology.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "mesh/half_edges.h"
#include "tiles/cell_key.h"

namespace colmap_ext {
namespace {

// Facets of which either what lies at vertices and edges of one section counts,
// or what lies at those that several sections share.
struct Part {
  std::vector<Facet> facets;       // of its vertices, valid ones
  std::vector<uint32_t> vertices;  // [V] the mesh's
  std::vector<uint8_t> is_shared;  // [V]
  bool is_seam = false;            // what is shared counts

  bool Counts(uint32_t vertex) const {
    return (is_shared[vertex] != 0) == is_seam;
  }
  bool Counts(uint32_t u, uint32_t v) const {
    return (is_shared[u] != 0 && is_shared[v] != 0) == is_seam;
  }
};

// What connects vertices of a part.
struct Links {
  explicit Links(size_t num_vertices)
      : components(num_vertices),
        loops(num_vertices),
        is_at_border(num_vertices, 0) {}

  UnionFind components;  // by facets
  UnionFind loops;       // by border edges that count
  std::vector<uint8_t> is_at_border;
};

void CountDuplicates(const Part& part, MeshReport* report) {
  std::vector<FacetKey> keys;
  keys.reserve(part.facets.size());
  for (const Facet& facet : part.facets) {
    const bool is_at_seams = std::ranges::all_of(
        facet, [&](uint32_t vertex) { return part.is_shared[vertex] != 0; });
    if (is_at_seams == part.is_seam) {
      keys.push_back(Sorted(facet));
    }
  }
  std::ranges::sort(keys);
  for (size_t i = 1; i < keys.size(); ++i) {
    report->num_duplicate_facets += keys[i] == keys[i - 1];
  }
}

// A vertex is singular where its facets form more than one fan, or more than
// two of them share one of its edges.
void CountVertices(const Part& part, const std::vector<uint8_t>& is_at_bad_edge,
                   UnionFind* fans, MeshReport* report) {
  std::vector<uint8_t> num_fans(part.vertices.size(), 0);  // 2: more than one
  for (uint32_t corner = 0; corner < 3 * part.facets.size(); ++corner) {
    uint8_t& count = num_fans[FromVertex(part.facets, corner)];
    if (fans->Find(corner) == corner && count < 2) {
      ++count;
    }
  }
  for (uint32_t vertex = 0; vertex < num_fans.size(); ++vertex) {
    if (part.Counts(vertex)) {
      report->num_unreferenced_vertices += num_fans[vertex] == 0;
      report->num_singular_vertices +=
          num_fans[vertex] > 1 || is_at_bad_edge[vertex] != 0;
    }
  }
}

Links Count(const Part& part, MeshReport* report) {
  const std::vector<Facet>& facets = part.facets;
  const size_t num_vertices = part.vertices.size();
  Links links(num_vertices);
  const auto num_corners = static_cast<uint32_t>(3 * facets.size());
  UnionFind fans(num_corners);
  std::vector<uint8_t> is_at_bad_edge(num_vertices, 0);
  // The corner of a half-edge's facet at one of its ends.
  const auto corner = [&](uint32_t half, uint32_t vertex) {
    const bool is_start = FromVertex(facets, half) == vertex;
    return is_start ? half : NextHalfEdge(half);
  };
  ForEachEdge(SortedHalfEdges(facets), [&](auto first, auto last) {
    const uint32_t u = FromVertex(facets, first->second);
    const uint32_t v = ToVertex(facets, first->second);
    size_t forward = 0;
    for (auto half = first; half != last; ++half) {
      forward += FromVertex(facets, half->second) == u;
      fans.Join(corner(first->second, u), corner(half->second, u));
      fans.Join(corner(first->second, v), corner(half->second, v));
    }
    links.components.Join(u, v);
    const auto count = static_cast<size_t>(last - first);
    if (count > 2) {
      is_at_bad_edge[u] = is_at_bad_edge[v] = 1;
    }
    if (!part.Counts(u, v)) {
      return;
    }
    ++report->num_edges;
    if (count == 1) {
      ++report->num_border_edges;
      links.is_at_border[u] = links.is_at_border[v] = 1;
      links.loops.Join(u, v);
    }
    report->num_non_manifold_edges += count > 2;
    report->num_misoriented_edges += forward > 1 || count - forward > 1;
  });
  CountDuplicates(part, report);
  CountVertices(part, is_at_bad_edge, &fans, report);
  return links;
}

// Sets of vertices that may go on from section to section.
class SetCounter {
 public:
  explicit SetCounter(size_t num_shared)
      : sets_(num_shared), is_there_(num_shared, 0) {}

  // \param is_in  [V] 1: in a set
  // \param place  vertex -> which shared vertex it is
  template <typename IsIn, typename Place>
  void Add(const Part& part, const IsIn& is_in, const Place& place,
           UnionFind* sets) {
    // [V] of a set's first vertex: one of its shared vertices.
    std::vector<uint32_t> shared(part.vertices.size(), kNoSource);
    for (uint32_t vertex = 0; vertex < part.vertices.size(); ++vertex) {
      if (is_in(vertex) && part.is_shared[vertex] != 0) {
        const auto at = static_cast<uint32_t>(place(part.vertices[vertex]));
        uint32_t& of_set = shared[sets->Find(vertex)];
        of_set = of_set == kNoSource ? at : of_set;
        sets_.Join(of_set, at);
        is_there_[at] = 1;
      }
    }
    for (uint32_t vertex = 0; vertex < part.vertices.size(); ++vertex) {
      num_closed_ += is_in(vertex) && sets->Find(vertex) == vertex &&
                     shared[vertex] == kNoSource;
    }
  }

  size_t Count() {
    size_t count = num_closed_;
    for (uint32_t i = 0; i < is_there_.size(); ++i) {
      count += is_there_[i] != 0 && sets_.Find(i) == i;
    }
    return count;
  }

 private:
  UnionFind sets_;                 // of shared vertices
  std::vector<uint8_t> is_there_;  // [shared]
  size_t num_closed_ = 0;          // within one section
};

// Drops facets that can not be looked at further.
void DropInvalid(uint32_t num_vertices, std::vector<Facet>* facets,
                 MeshReport* report) {
  std::erase_if(*facets, [&](const Facet& facet) {
    const auto& [a, b, c] = facet;
    const bool is_invalid = std::ranges::max(facet) >= num_vertices;
    const bool is_degenerate = a == b || b == c || c == a;
    report->num_invalid_facets += is_invalid;
    report->num_degenerate_facets += is_degenerate && !is_invalid;
    return is_invalid || is_degenerate;
  });
}

// \param begin, end  vertices that have to be there
Part MakePart(const SectionedMesh& mesh, uint32_t begin, uint32_t end,
              std::vector<Facet> facets) {
  std::vector<uint32_t> others;
  for (const Facet& facet : facets) {
    std::ranges::copy_if(
        facet, std::back_inserter(others),
        [&](uint32_t vertex) { return vertex < begin || vertex >= end; });
  }
  std::ranges::sort(others);
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (Facet& facet : facets) {
    for (uint32_t& vertex : facet) {
      const bool is_other = vertex < begin || vertex >= end;
      vertex = is_other ? end - begin +
                              static_cast<uint32_t>(
                                  std::ranges::lower_bound(others, vertex) -
                                  others.begin())
                        : vertex - begin;
    }
  }
  Part part;
  part.facets = std::move(facets);
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
    part.vertices.push_back(vertex);
  }
  part.vertices.insert(part.vertices.end(), others.begin(), others.end());
  for (const uint32_t vertex : part.vertices) {
    part.is_shared.push_back(mesh.IsShared(vertex));
  }
  return part;
}

// Appends the facets at shared vertices, of the mesh's vertices.
void AddAtSeams(const Part& part, std::vector<Facet>* facets) {
  for (Facet facet : part.facets) {
    if (std::ranges::any_of(facet, [&](uint32_t vertex) {
          return part.is_shared[vertex] != 0;
        })) {
      for (uint32_t& vertex : facet) {
        vertex = part.vertices[vertex];
      }
      facets->push_back(facet);
    }
  }
}

Part ReadSection(const SectionedMesh& mesh, size_t section,
                 MeshReport* report) {
  const uint32_t begin = mesh.FirstVertex(section);
  const uint32_t end = mesh.FirstVertex(section + 1);
  for (const Eigen::Vector3f& position : mesh.ReadPositions(begin, end)) {
    report->num_non_finite_vertices += !position.allFinite();
  }
  std::vector<Facet> facets =
      mesh.ReadFacets(mesh.FirstFacet(section), mesh.FirstFacet(section + 1));
  DropInvalid(mesh.NumVertices(), &facets, report);
  return MakePart(mesh, begin, end, std::move(facets));
}

}  // namespace

MeshReport AnalyzeSections(const SectionedMesh& mesh) {
  MeshReport report;
  report.num_vertices = mesh.NumVertices();
  report.num_facets = mesh.NumFacets();
  const std::vector<uint32_t>& shared = mesh.AllShared();
  const auto place = [&](uint32_t vertex) {
    return std::ranges::lower_bound(shared, vertex) - shared.begin();
  };
  SetCounter components(shared.size());
  SetCounter loops(shared.size());
  const auto count = [&](const Part& part) {
    Links links = Count(part, &report);
    components.Add(
        part, [](uint32_t) { return true; }, place, &links.components);
    loops.Add(
        part, [&](uint32_t vertex) { return links.is_at_border[vertex] != 0; },
        place, &links.loops);
  };
  std::vector<Facet> at_seams;
  for (size_t section = 0; section < mesh.NumSections(); ++section) {
    const Part part = ReadSection(mesh, section, &report);
    AddAtSeams(part, &at_seams);
    count(part);
  }
  Part seams = MakePart(mesh, 0, 0, std::move(at_seams));
  seams.is_seam = true;
  report.num_unreferenced_vertices +=
      shared.size() -
      static_cast<size_t>(std::ranges::count(seams.is_shared, 1));
  count(seams);
  report.num_components = components.Count();
  report.num_border_loops = loops.Count();
  report.DeriveGenus();
  return report;
}

}  // namespace colmap_ext
