#include "merging/facet_rings.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

namespace colmap_ext {
namespace {

// How many edges vertices are off some facets.
class RingSearch {
 public:
  RingSearch(const SectionedMesh& mesh, uint8_t num_rings)
      : mesh_(mesh), num_rings_(num_rings) {}

  void Start(const std::vector<uint32_t>& facets) {
    for (const uint32_t number : facets) {
      const Facet facet = mesh_.ReadFacets(number, number + 1)[0];
      for (const uint32_t vertex : facet) {
        Reach(vertex, 0, mesh_.NumSections());
      }
    }
  }

  FacetList Run() {
    std::map<size_t, FacetList> found;
    while (!waiting_.empty()) {
      const size_t section = *waiting_.begin();
      waiting_.erase(waiting_.begin());
      found[section] = SearchIn(section);
    }
    FacetList list;
    for (const auto& [section, of_section] : found) {
      list.facets.insert(list.facets.end(), of_section.facets.begin(),
                         of_section.facets.end());
    }
    return list;
  }

 private:
  // Has other sections than one go on from a vertex.
  void Reach(uint32_t vertex, uint8_t ring, size_t but) {
    const auto [found, is_new] = rings_.try_emplace(vertex, ring);
    if (!is_new && found->second <= ring) {
      return;
    }
    found->second = ring;
    for (size_t section = 0; section < mesh_.NumSections(); ++section) {
      if (section != but && Has(section, vertex)) {
        waiting_.insert(section);
      }
    }
  }

  bool Has(size_t section, uint32_t vertex) const {
    return (vertex >= mesh_.FirstVertex(section) &&
            vertex < mesh_.FirstVertex(section + 1)) ||
           std::ranges::binary_search(mesh_.Shared(section), vertex);
  }

  // Goes on from all that is known of a section's vertices.
  FacetList SearchIn(size_t section) {
    const uint32_t first = mesh_.FirstFacet(section);
    const std::vector<Facet> facets =
        mesh_.ReadFacets(first, mesh_.FirstFacet(section + 1));
    SetOwn(section);
    for (uint8_t ring = 0; ring < num_rings_; ++ring) {
      for (const Facet& facet : facets) {
        if (RingOf(facet) != ring) {
          continue;
        }
        for (const uint32_t vertex : facet) {
          if (RingOf(vertex) > ring + 1) {
            SetRing(section, vertex, ring + 1);
          }
        }
      }
    }
    FacetList found;
    for (uint32_t i = 0; i < facets.size(); ++i) {
      if (RingOf(facets[i]) <= num_rings_) {
        found.Add(first + i, facets[i]);
      }
    }
    return found;
  }

  void SetOwn(size_t section) {
    begin_ = mesh_.FirstVertex(section);
    own_.assign(mesh_.FirstVertex(section + 1) - begin_, Beyond());
    for (const auto& [vertex, ring] : rings_) {
      if (IsOwn(vertex)) {
        own_[vertex - begin_] = ring;
      }
    }
  }

  void SetRing(size_t section, uint32_t vertex, uint8_t ring) {
    if (IsOwn(vertex)) {
      own_[vertex - begin_] = ring;
    }
    if (std::ranges::binary_search(mesh_.Shared(section), vertex)) {
      Reach(vertex, ring, section);
    } else {
      rings_[vertex] = ring;
    }
  }

  bool IsOwn(uint32_t vertex) const {
    return vertex >= begin_ && vertex - begin_ < own_.size();
  }

  uint8_t Beyond() const { return num_rings_ + 1; }

  uint8_t RingOf(uint32_t vertex) const {
    if (IsOwn(vertex)) {
      return own_[vertex - begin_];
    }
    const auto found = rings_.find(vertex);
    return found == rings_.end() ? Beyond() : found->second;
  }

  uint8_t RingOf(const Facet& facet) const {
    return std::min({RingOf(facet[0]), RingOf(facet[1]), RingOf(facet[2])});
  }

  const SectionedMesh& mesh_;
  const uint8_t num_rings_;
  std::unordered_map<uint32_t, uint8_t> rings_;  // of vertices
  std::set<size_t> waiting_;                     // sections
  // Of the section that is being searched: the same of its own vertices.
  uint32_t begin_ = 0;
  std::vector<uint8_t> own_;
};

}  // namespace

MeshPart FacetList::Gather(const SectionedMesh& mesh) {
  std::ranges::sort(facets);
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  std::vector<uint32_t> numbers;
  std::vector<Facet> gathered;
  for (const auto& [number, facet] : facets) {
    numbers.push_back(number);
    gathered.push_back(facet);
  }
  return GatherPart(mesh, std::move(numbers), std::move(gathered));
}

FacetList FacetsAround(const SectionedMesh& mesh,
                       const std::vector<uint32_t>& facets, uint8_t num_rings) {
  RingSearch search(mesh, num_rings);
  search.Start(facets);
  return search.Run();
}

}  // namespace colmap_ext
