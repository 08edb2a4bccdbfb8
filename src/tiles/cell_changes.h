#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "meshing/manifold_fixing.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"
#include "tiles/seam_labels.h"
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

// What the tiles have left with the labels of the seams, and as fixing has
// changed it.
class LabeledParts {
 public:
  // \pre all of these outlive it
  LabeledParts(const TileParts& parts, const SeamLabels& seam,
               const CellChanges& changes)
      : parts_(parts), seam_(seam), changes_(changes) {}

  // Labels are kMatter or kFreeSpace.
  TilePart Read(uint32_t tile) const {
    TilePart part = parts_.ReadPart(tile);
    ApplySeamLabels(seam_, part.tile, &part.labels);
    changes_.Apply(&part);
    return part;
  }

  // The tile of a vertex of the plan or of a centroid.
  uint32_t TileOf(uint32_t vertex) const { return changes_.TileOf(vertex); }

 private:
  const TileParts& parts_;
  const SeamLabels& seam_;
  const CellChanges& changes_;
};

// Fixes the singular vertices of a plan (FixSingularVertices), tile by tile: in
// two rings of cells around them, whichever tiles these are of, with what has
// been changed before. Flips at a vertex concern its own cells, and are judged
// by the cells of their vertices. Rings around vertices that become singular on
// the way are added then. So it takes memory for the rings of one tile, and for
// one tile.
//
// \param at_once  all tiles in one go: the result is that of one machine
// \return num_singular_raw counts those that are singular when it is the turn
//         of their tile
FixingReport FixPlan(const PlanVertices& plan, const TileParts& parts,
                     const SeamLabels& seam, FixingRule rule, bool at_once,
                     CellChanges* changes, const Progress& progress = {});

}  // namespace colmap_ext
