#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/byte_store.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A mesh in sections, of which one is held at a time. Vertices are numbered in
// the order in which facets use them, section after section: a facet has
// vertices of its section or of those before.
class SectionedMesh {
 public:
  explicit SectionedMesh(const MakeStore& make_store)
      : positions_(make_store), facets_(make_store) {}

  // Adds the next section.
  // \param positions  of the vertices that it is the first to use
  // \param facets     of the mesh's vertices
  // \param shared     its vertices that other sections have, too; ascending
  // \param boxes      [F] around the facets
  // \throw std::invalid_argument if the mesh gets more than 32 bits can number.
  void Add(const std::vector<Eigen::Vector3f>& positions,
           const std::vector<Facet>& facets, std::vector<uint32_t> shared,
           const std::vector<Eigen::AlignedBox3f>& boxes);

  // To be called after the last section.
  void Finish();

  size_t NumSections() const { return shared_.size(); }
  uint32_t NumVertices() const { return first_vertices_.back(); }
  uint32_t NumFacets() const { return first_facets_.back(); }
  // Of the number of sections: the end.
  uint32_t FirstVertex(size_t section) const {
    return first_vertices_[section];
  }
  uint32_t FirstFacet(size_t section) const { return first_facets_[section]; }

  // The section of a facet.
  size_t SectionOf(uint32_t facet) const;

  // Vertices of a section that others have, too, ascending.
  const std::vector<uint32_t>& Shared(size_t section) const {
    return shared_[section];
  }
  bool IsShared(uint32_t vertex) const;
  // Those of all sections, ascending.
  const std::vector<uint32_t>& AllShared() const { return all_shared_; }

  std::vector<Facet> ReadFacets(uint32_t begin, uint32_t end) const {
    return facets_.Read(begin, end);
  }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const {
    return positions_.Read(begin, end);
  }
  // \param vertices  ascending
  std::vector<Eigen::Vector3f> PositionsOf(
      const std::vector<uint32_t>& vertices) const;

  // Calls visit(first, facets) for blocks of a section's facets whose boxes
  // may_meet(box) holds for.
  template <typename MayMeet, typename Visit>
  void ForEachBlock(size_t section, const MayMeet& may_meet,
                    const Visit& visit) const {
    for (size_t i = 0; i < boxes_[section].size(); ++i) {
      if (may_meet(boxes_[section][i])) {
        const uint32_t begin =
            FirstFacet(section) + static_cast<uint32_t>(i) * kBlock;
        visit(begin, ReadFacets(begin, std::min(begin + kBlock,
                                                FirstFacet(section + 1))));
      }
    }
  }

  void Move(uint32_t vertex, const Eigen::Vector3f& position) {
    positions_.Set(vertex, position);
  }
  // Puts another facet in a facet's place, or the same whose vertices moved.
  // \param box  around it
  void Replace(uint32_t index, const Facet& facet,
               const Eigen::AlignedBox3f& box);

 private:
  static constexpr uint32_t kBlock = 512;  // facets

  StoredVector<Eigen::Vector3f> positions_;
  StoredVector<Facet> facets_;
  std::vector<uint32_t> first_vertices_{0};    // [sections + 1]
  std::vector<uint32_t> first_facets_{0};      // [sections + 1]
  std::vector<std::vector<uint32_t>> shared_;  // [sections]
  // [sections] around each kBlock facets
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes_;
  std::vector<uint32_t> all_shared_;  // ascending
};

// Facets of a sectioned mesh as a mesh.
struct MeshPart {
  TriangleMesh mesh;
  std::vector<uint32_t> vertices;  // [V] ascending
  std::vector<uint32_t> facets;    // [F] ascending
};

// \param numbers  [F] of the facets, ascending
// \param facets   [F] of the mesh's vertices
MeshPart GatherPart(const SectionedMesh& mesh, std::vector<uint32_t> numbers,
                    std::vector<Facet> facets);

}  // namespace colmap_ext
