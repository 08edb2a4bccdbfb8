#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// [tiles] boxes that share out all space, infinite outwards; a lower side
// belongs to the box, an upper one to the next. See SplitTree::Cells().
using TileCells = std::vector<Eigen::AlignedBox3f>;

// Space cut by planes across the axes into parts of about equal weight.
class SplitTree {
 public:
  // Each part is cut where its weight is shared out, across the axis along
  // which its points spread most.
  // \param weights [points] positive
  // \param num_parts 1 or more, at most the number of points
  SplitTree(const std::vector<Eigen::Vector3f>& points,
            const std::vector<float>& weights, size_t num_parts);

  // Points at one place are in one part.
  uint32_t PartOf(const Eigen::Vector3f& point) const;

  // [parts] the boxes of the parts, infinite outwards.
  const TileCells& Cells() const { return cells_; }

 private:
  struct Node {
    int axis;
    float border;          // coordinates below are in the first child
    uint32_t children[2];  // nodes, or kLeaf + part
  };
  static constexpr uint32_t kLeaf = 1u << 31;

  // Splits points into so many parts from first_part on, which share out a box.
  // \return the node, or kLeaf + part
  uint32_t Build(const std::vector<Eigen::Vector3f>& points,
                 const std::vector<float>& weights, std::span<uint32_t> part,
                 uint32_t first_part, uint32_t num_parts,
                 const Eigen::AlignedBox3f& box);

  std::vector<Node> nodes_;
  TileCells cells_;
  uint32_t root_ = kLeaf;
};

// The tile in whose cell a point lies.
uint32_t CellOf(const TileCells& cells, const Eigen::Vector3f& point);

// Gives tiles colours such that no facet's box comes near the cells of two
// tiles of one colour: tiles of one colour can be worked on at once. Greedy, in
// the tiles' order.
// \param reaches [tiles] what counts as near a cell, scene units
// \return [tiles] from 0 on
std::vector<uint32_t> ColorTiles(const TileCells& cells,
                                 const std::vector<float>& reaches,
                                 const TriangleMesh& mesh);

// Whether something within a box may lie between a camera and what another box
// encloses, or within that: whether the box meets the hull of the camera's
// centre and the other one.
// \pre neither box is empty
bool MayHide(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& center,
             const Eigen::AlignedBox3f& seen);

}  // namespace colmap_ext
