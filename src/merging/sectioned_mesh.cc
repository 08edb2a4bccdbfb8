#include "merging/sectioned_mesh.h"

#include <utility>

#include "base/index_limit.h"

namespace colmap_ext {

void SectionedMesh::Add(const std::vector<Eigen::Vector3f>& positions,
                        const std::vector<Facet>& facets,
                        std::vector<uint32_t> shared,
                        const std::vector<Eigen::AlignedBox3f>& boxes) {
  positions_.Append(positions);
  facets_.Append(facets);
  first_vertices_.push_back(ExpectIndexable(positions_.size(), "vertices"));
  first_facets_.push_back(ExpectIndexable(facets_.size(), "faces"));
  all_shared_.insert(all_shared_.end(), shared.begin(), shared.end());
  shared_.push_back(std::move(shared));
  std::vector<Eigen::AlignedBox3f>& blocks = boxes_.emplace_back();
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (i % kBlock == 0) {
      blocks.emplace_back();
    }
    blocks.back().extend(boxes[i]);
  }
}

void SectionedMesh::Finish() {
  std::ranges::sort(all_shared_);
  all_shared_.erase(std::unique(all_shared_.begin(), all_shared_.end()),
                    all_shared_.end());
  all_shared_.shrink_to_fit();
}

size_t SectionedMesh::SectionOf(uint32_t facet) const {
  return static_cast<size_t>(std::ranges::upper_bound(first_facets_, facet) -
                             first_facets_.begin() - 1);
}

bool SectionedMesh::IsShared(uint32_t vertex) const {
  return std::ranges::binary_search(all_shared_, vertex);
}

std::vector<Eigen::Vector3f> SectionedMesh::PositionsOf(
    const std::vector<uint32_t>& vertices) const {
  // Vertices that are not needed, but read to be done with one reading.
  constexpr uint32_t kMaxGap = 256;
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(vertices.size());
  for (auto first = vertices.begin(); first != vertices.end();) {
    auto last = first + 1;
    while (last != vertices.end() && *last - *(last - 1) <= kMaxGap) {
      ++last;
    }
    const auto run = ReadPositions(*first, *(last - 1) + 1);
    for (auto vertex = first; vertex != last; ++vertex) {
      positions.push_back(run[*vertex - *first]);
    }
    first = last;
  }
  return positions;
}

void SectionedMesh::Replace(uint32_t index, const Facet& facet,
                            const Eigen::AlignedBox3f& box) {
  facets_.Set(index, facet);
  const size_t section = SectionOf(index);
  boxes_[section][(index - FirstFacet(section)) / kBlock].extend(box);
}

MeshPart GatherPart(const SectionedMesh& mesh, std::vector<uint32_t> numbers,
                    std::vector<Facet> facets) {
  MeshPart part;
  for (const Facet& facet : facets) {
    part.vertices.insert(part.vertices.end(), facet.begin(), facet.end());
  }
  std::ranges::sort(part.vertices);
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()),
                      part.vertices.end());
  for (Facet& facet : facets) {
    for (uint32_t& vertex : facet) {
      vertex = static_cast<uint32_t>(
          std::ranges::lower_bound(part.vertices, vertex) -
          part.vertices.begin());
    }
  }
  part.mesh.vertices = mesh.PositionsOf(part.vertices);
  part.mesh.facets = std::move(facets);
  part.facets = std::move(numbers);
  return part;
}

}  // namespace colmap_ext
