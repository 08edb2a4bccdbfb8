#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "tiles/cell_key.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// What fixing singular vertices has made of a plan's cells: other labels, and
// four cells of one. Centroids are vertices from the plan's number of vertices
// on. Corners are in any order.
class CellChanges {
 public:
  // \pre it outlives this
  explicit CellChanges(const PlanBlocks& blocks) : blocks_(blocks) {}

  // \return the vertex at the centroid
  uint32_t Split(const CellKey& corners, const Eigen::Vector3f& centroid);
  void SetLabel(const CellKey& corners, uint8_t label);

  // The vertex at the centroid of a cell that is split.
  std::optional<uint32_t> CentroidOf(const CellKey& corners) const;
  // That of a cell of another label than its tile or the seams give it, and of
  // all parts of cells.
  std::optional<uint8_t> LabelOf(const CellKey& corners) const;

  // The tile of a vertex; a centroid is of the first tile of its cell.
  uint32_t TileOf(uint32_t vertex) const;

  // By their vertices.
  const std::vector<Eigen::Vector3f>& centroids() const { return centroids_; }

  // Makes them in what a tile has.
  // \param part  with all labels; its vertices get more
  void Apply(TilePart* part) const;

 private:
  void ApplyTo(uint32_t cell, TilePart* part) const;

  const PlanBlocks& blocks_;
  std::unordered_map<CellKey, uint32_t, KeyHash> splits_;
  std::unordered_map<CellKey, uint8_t, KeyHash> labels_;
  std::unordered_set<uint32_t> vertices_;  // of all these
  std::vector<Eigen::Vector3f> centroids_;
  std::vector<uint32_t> tiles_;  // [centroids]
};

}  // namespace colmap_ext
