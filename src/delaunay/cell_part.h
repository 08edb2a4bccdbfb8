#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// Some of the cells of a tetrahedralization, and where rays may come in: a
// hierarchy of boxes over the facets of its border [Wald2007].
class CellPart {
 public:
  // \param is_inside [cells]
  CellPart(const Tetrahedralization& tetrahedra,
           std::vector<uint8_t> is_inside);

  bool Has(uint32_t cell) const { return is_inside_[cell] != 0; }

  // Whether a vertex is a corner of one of the cells.
  bool IsCorner(uint32_t vertex) const { return is_corner_[vertex] != 0; }

  // Calls visit(arc) for facets of the border that a line may pass through from
  // one place to the other: 4 * cell + facet of the cell that is not of the
  // part.
  template <typename Visit>
  void SearchBorder(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const Visit& visit) const;

 private:
  using Float4 = float __attribute__((vector_size(16)));
  struct Node {
    Float4 min, max;    // of the facets, from origin_; the fourth is 0
    uint32_t next;      // leaf: its first arc; else the far child, the near one
                        // follows
    uint32_t num_arcs;  // leaf: > 0; else 0
  };
  // Where a segment begins, from origin_, less and more by what rounding can
  // do, and the inverse of its way.
  struct Segment {
    Float4 before, after, inverse;
  };
  struct Builder;

  Segment SegmentOf(const Eigen::Vector3d& from,
                    const Eigen::Vector3d& to) const;
  static bool Meets(const Node& node, const Segment& segment);

  std::vector<uint8_t> is_inside_;                    // [cells]
  std::vector<uint8_t> is_corner_;                    // [V]
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // amid the facets
  double extent_ = 0;  // of their farthest coordinate from there
  std::vector<Node> nodes_;
  std::vector<uint32_t> arcs_;  // in the order of the leaves
};

template <typename Visit>
void CellPart::SearchBorder(const Eigen::Vector3d& from,
                            const Eigen::Vector3d& to,
                            const Visit& visit) const {
  constexpr size_t kMaxDepth = 64;
  const Segment segment = SegmentOf(from, to);
  std::array<uint32_t, kMaxDepth> stack;
  size_t num_left = 0;
  if (!nodes_.empty()) {
    stack[num_left++] = 0;
  }
  while (num_left > 0) {
    const uint32_t index = stack[--num_left];
    const Node& node = nodes_[index];
    if (!Meets(node, segment)) {
      continue;
    }
    if (node.num_arcs == 0) {
      stack[num_left++] = node.next;
      stack[num_left++] = index + 1;
      continue;
    }
    for (uint32_t i = 0; i < node.num_arcs; ++i) {
      visit(arcs_[node.next + i]);
    }
  }
}

inline bool CellPart::Meets(const Node& node, const Segment& segment) {
  const Float4 a = (node.min - segment.after) * segment.inverse;
  const Float4 b = (node.max - segment.before) * segment.inverse;
  const Float4 low = a < b ? a : b;
  const Float4 high = a < b ? b : a;
  const float begin = std::max(std::max(low[0], low[1]), low[2]);
  const float end = std::min(std::min(high[0], high[1]), high[2]);
  return std::max(begin, 0.0F) <= std::min(end, 1.0F);
}

}  // namespace colmap_ext
