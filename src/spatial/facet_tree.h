#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The bounding box of a facet.
// \pre its indices are in range
Eigen::AlignedBox3f BoxOf(const TriangleMesh& mesh, const Facet& facet);
Eigen::AlignedBox3f BoxOf(const TriangleMesh& mesh, uint32_t facet);

// The box, larger by a margin on each side.
template <typename Scalar>
Eigen::AlignedBox<Scalar, 3> GrowBox(const Eigen::AlignedBox<Scalar, 3>& box,
                                     std::type_identity_t<Scalar> margin) {
  return {box.min().array() - margin, box.max().array() + margin};
}

// A balanced tree of bounding boxes over the facets of a mesh, to find facets
// whose boxes meet. A heap: node i has the children 2 i + 1 and 2 i + 2; the
// leaves hold equal shares of the facets.
//
// As vertices move, the boxes can follow. The order of the facets stays, so
// that a tree stays quick as long as they move little.
class FacetTree {
 public:
  using Box = Eigen::AlignedBox3f;

  // \pre facet indices are in range, the facets' vertices are finite
  explicit FacetTree(const TriangleMesh& mesh);

  // A tree of some of the facets, to be searched only.
  // \param facets  indices, each once
  FacetTree(const TriangleMesh& mesh, std::span<const uint32_t> facets);

  // Sets the boxes to those of the facets at two sets of positions, and of all
  // positions on the straight ways between them.
  // \pre both meshes have the facets of the tree's mesh, and finite vertices
  void Enclose(const TriangleMesh& from, const TriangleMesh& to);

  // Extends the boxes of the given facets to the positions that they have.
  // \param facets  indices
  // \pre as above
  void Extend(const TriangleMesh& mesh, const std::vector<uint32_t>& facets);

  size_t NumLeaves() const { return (nodes_.size() + 1) / 2; }

  // Calls function(a, b) once for each two facets whose boxes meet, one of them
  // in the given leaf, the other in the same or a later leaf. a may be more
  // than b.
  // \pre leaf < NumLeaves()
  template <typename Function>
  void ForEachPair(size_t leaf, const Function& function) const {
    const size_t first = First(leaf);
    const size_t last = First(leaf + 1);
    const Box& box = nodes_[NumLeaves() - 1 + leaf];
    ForEachLeafIn(box, leaf, 0, 0, NumLeaves(), [&](size_t other_leaf) {
      const size_t other_last = First(other_leaf + 1);
      const Box& other_box = nodes_[NumLeaves() - 1 + other_leaf];
      for (size_t i = first; i < last; ++i) {
        if (!boxes_[i].intersects(other_box)) {
          continue;
        }
        for (size_t j = other_leaf == leaf ? i + 1 : First(other_leaf);
             j < other_last; ++j) {
          if (boxes_[i].intersects(boxes_[j])) {
            function(facets_[i], facets_[j]);
          }
        }
      }
    });
  }

  // Calls function(facet) once for each facet whose box meets the given one.
  template <typename Function>
  void ForEachNear(const Box& box, const Function& function) const {
    ForEachLeafIn(box, 0, 0, 0, NumLeaves(), [&](size_t leaf) {
      const size_t last = First(leaf + 1);
      for (size_t i = First(leaf); i < last; ++i) {
        if (boxes_[i].intersects(box)) {
          function(facets_[i]);
        }
      }
    });
  }

 protected:
  // Visits the leaves whose bounds are below a limit, depth first, the child
  // with the lower bound before the other.
  // \param bound_of  of a box: not above that of a box within it
  // \param visit  gets a leaf's range of facets_, and returns the new limit
  template <typename Limit, typename BoundOf, typename Visit>
  void VisitNearestFirst(Limit limit, const BoundOf& bound_of,
                         const Visit& visit) const {
    constexpr size_t kMaxDepth = 32;
    std::array<std::pair<Limit, size_t>, kMaxDepth + 1> stack;
    size_t size = 0;
    stack[size++] = {bound_of(nodes_[0]), 0};
    while (size > 0) {
      const auto [bound, node] = stack[--size];
      if (!(bound < limit)) {
        continue;
      }
      if (node + 1 >= NumLeaves()) {
        const size_t leaf = node + 1 - NumLeaves();
        limit = visit(First(leaf), First(leaf + 1));
        continue;
      }
      std::pair near{bound_of(nodes_[2 * node + 1]), 2 * node + 1};
      std::pair far{bound_of(nodes_[2 * node + 2]), 2 * node + 2};
      if (far.first < near.first) {
        std::swap(near, far);
      }
      stack[size++] = far;
      stack[size++] = near;
    }
  }

  // The first facet of a leaf, in the order of the leaves.
  size_t First(size_t leaf) const {
    return leaf * facets_.size() / NumLeaves();
  }

  std::vector<Box> nodes_;        // a power of two of leaves, the last ones
  std::vector<uint32_t> facets_;  // [F], in the order of the leaves
  std::vector<Box> boxes_;        // [F], in the order of the leaves

 private:
  // The leaf that holds a place: the last one whose first place is not beyond.
  size_t LeafOf(size_t place) const {
    return ((place + 1) * NumLeaves() - 1) / facets_.size();
  }

  void Sort(size_t first_leaf, size_t last_leaf, const std::vector<Box>& boxes);
  void FillNodes();

  // Calls function(leaf) for the leaves from `start` on whose boxes meet the
  // given one, within a node that holds [first, last).
  template <typename Function>
  void ForEachLeafIn(const Box& box, size_t start, size_t node, size_t first,
                     size_t last, const Function& function) const {
    if (last <= start || !nodes_[node].intersects(box)) {
      return;
    }
    if (last - first == 1) {
      function(first);
      return;
    }
    const size_t middle = first + (last - first) / 2;
    ForEachLeafIn(box, start, 2 * node + 1, first, middle, function);
    ForEachLeafIn(box, start, 2 * node + 2, middle, last, function);
  }

  std::vector<uint32_t> places_;  // [F] index of each facet in facets_;
                                  // empty of a tree of some
};

// A binary tree over a list of boxes, whose neighbors in the list are near each
// other: each node has the box around a range of the list.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Eigen::AlignedBox3f>& boxes)
      : num_leaves_(std::bit_ceil(std::max<size_t>(boxes.size(), 1))),
        nodes_(2 * num_leaves_) {
    std::ranges::copy(boxes,
                      nodes_.begin() + static_cast<ptrdiff_t>(num_leaves_));
    for (size_t node = num_leaves_ - 1; node > 0; --node) {
      nodes_[node] = nodes_[2 * node].merged(nodes_[2 * node + 1]);
    }
  }

  // Calls visit(i) for the boxes that may_touch(box) holds for, ascending,
  // until it returns true. may_touch has to hold for what is around such a box.
  // \return whether a call did
  template <typename MayTouch, typename Visit>
  bool Search(const MayTouch& may_touch, const Visit& visit) const {
    std::vector<size_t> stack(1, 1);
    while (!stack.empty()) {
      const size_t node = stack.back();
      stack.pop_back();
      if (node >= nodes_.size() || nodes_[node].isEmpty() ||
          !may_touch(nodes_[node])) {
        continue;
      }
      if (node < num_leaves_) {
        stack.push_back(2 * node + 1);
        stack.push_back(2 * node);
      } else if (visit(static_cast<uint32_t>(node - num_leaves_))) {
        return true;
      }
    }
    return false;
  }

  // Whether predicate(box) holds for any box; it has to hold for what is around
  // such a box.
  template <typename Predicate>
  bool AnyOf(const Predicate& predicate) const {
    return Search(predicate, [](uint32_t /*i*/) { return true; });
  }

 private:
  size_t num_leaves_ = 1;  // a power of two
  // Node i has the children 2 i and 2 i + 1; the first leaf is num_leaves_.
  std::vector<Eigen::AlignedBox3f> nodes_;
};

}  // namespace colmap_ext
