#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A balanced tree of bounding boxes over the facets of a mesh, to find facets
// whose boxes meet. A heap: node i has the children 2 i + 1 and 2 i + 2; the
// leaves hold equal shares of the facets.
class FacetTree {
 public:
  using Box = Eigen::AlignedBox3f;

  // \pre facet indices are in range, the facets' vertices are finite
  explicit FacetTree(const TriangleMesh& mesh);

  size_t NumLeaves() const { return (nodes_.size() + 1) / 2; }

  // Calls function(a, b) once for each two facets whose boxes meet, one of them
  // in the given leaf, the other in the same or a later leaf. a may be more
  // than b.
  // \pre leaf < NumLeaves()
  template <typename Function>
  void ForEachPair(size_t leaf, const Function& function) const {
    const size_t first = First(leaf);
    const size_t last = First(leaf + 1);
    ForEachIn(0, 0, NumLeaves(), leaf, [&](size_t other_leaf) {
      const size_t other_last = First(other_leaf + 1);
      for (size_t i = first; i < last; ++i) {
        for (size_t j = other_leaf == leaf ? i + 1 : First(other_leaf);
             j < other_last; ++j) {
          if (boxes_[i].intersects(boxes_[j])) {
            function(facets_[i], facets_[j]);
          }
        }
      }
    });
  }

 private:
  // The first facet of a leaf, in the order of the leaves.
  size_t First(size_t leaf) const {
    return leaf * facets_.size() / NumLeaves();
  }

  void Sort(size_t first_leaf, size_t last_leaf, const std::vector<Box>& boxes);
  void FillNodes();

  // Calls function(other) for the leaves not before a leaf whose boxes meet
  // that of the leaf, within a node that holds [first, last).
  template <typename Function>
  void ForEachIn(size_t node, size_t first, size_t last, size_t leaf,
                 const Function& function) const {
    if (last <= leaf ||
        !nodes_[node].intersects(nodes_[NumLeaves() - 1 + leaf])) {
      return;
    }
    if (last - first == 1) {
      function(first);
      return;
    }
    const size_t middle = first + (last - first) / 2;
    ForEachIn(2 * node + 1, first, middle, leaf, function);
    ForEachIn(2 * node + 2, middle, last, leaf, function);
  }

  std::vector<Box> nodes_;        // a power of two of leaves, the last ones
  std::vector<uint32_t> facets_;  // [F], in the order of the leaves
  std::vector<Box> boxes_;        // [F], in the order of the leaves
};

}  // namespace colmap_ext
