#include "merging/band_numbers.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace colmap_ext {

NumberedBand BandNumbers::Add(const FanSplit& surface,
                              const std::vector<FacetKey>& keys,
                              const std::vector<uint8_t>& is_own) {
  const std::vector<Facet>& facets = surface.mesh.facets;
  const size_t num_vertices = surface.mesh.vertices.size();
  std::vector<uint32_t> firsts(num_vertices, kNoSource);  // facets
  std::vector<uint8_t> is_shared(num_vertices, 0);
  for (uint32_t i = 0; i < facets.size(); ++i) {
    for (const uint32_t vertex : facets[i]) {
      firsts[vertex] = std::min(firsts[vertex], i);
      is_shared[vertex] |= is_own[surface.facet_sources[i]] == 0;
    }
  }
  const auto name_of = [&](uint32_t vertex) {
    const auto& [a, b] = surface.sources[vertex];
    const Eigen::Vector3f& position = surface.mesh.vertices[vertex];
    const FacetKey& key = keys[surface.facet_sources[firsts[vertex]]];
    return Name{a,
                b,
                key[0],
                key[1],
                key[2],
                std::bit_cast<uint32_t>(position.x()),
                std::bit_cast<uint32_t>(position.y()),
                std::bit_cast<uint32_t>(position.z())};
  };
  NumberedBand band;
  std::vector<uint32_t> numbers(num_vertices, kNoSource);
  const auto number = [&](uint32_t vertex) {
    if (is_own[surface.facet_sources[firsts[vertex]]] == 0) {
      const auto found = shared_.find(name_of(vertex));
      if (found == shared_.end()) {
        throw std::logic_error("the bands of the surface do not fit together");
      }
      numbers[vertex] = found->second;
    } else {
      numbers[vertex] = num_vertices_++;
      band.new_vertices.push_back(vertex);
      if (is_shared[vertex] != 0) {
        shared_[name_of(vertex)] = numbers[vertex];
      }
    }
    if (is_shared[vertex] != 0) {
      band.shared.push_back(numbers[vertex]);
    }
  };
  for (uint32_t i = 0; i < facets.size(); ++i) {
    if (is_own[surface.facet_sources[i]] == 0) {
      continue;
    }
    Facet facet = facets[i];
    for (uint32_t& vertex : facet) {
      if (numbers[vertex] == kNoSource) {
        number(vertex);
      }
      vertex = numbers[vertex];
    }
    band.facets.push_back(facet);
    band.own.push_back(i);
  }
  std::ranges::sort(band.shared);
  return band;
}

}  // namespace colmap_ext
