#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"
#include "base/lru_cache.h"
#include "meshing/fix_singular_vertices.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_cut.h"

// What the tiles of a plan have left is merged: the seams are cut, singular
// vertices are fixed, and the surface is extracted.
namespace colmap_ext {

// A cell whose label its tile could not determine, or that tiles share.
struct SeamCell {
  uint8_t label;
  uint32_t tile;   // that it belongs to
  uint32_t place;  // in TileSeam::unknown; kNone: label is known

  bool IsUnknown() const { return place != kNone; }
};

// The labels of these cells of a plan. Holds a byte for each cell of unknown
// label, and the seams of the tiles that were read last.
class SeamLabels {
 public:
  // Starts with the labels that the tiles guess.
  // \pre both outlive it
  SeamLabels(const PlanVertices& plan, const TileParts& parts);

  const PlanVertices& plan() const { return plan_; }
  const TileParts& parts() const { return parts_; }

  size_t NumTiles() const { return labels_.size(); }

  // Cells whose labels their tile could not determine.
  size_t NumUnknown(uint32_t tile) const { return labels_[tile].size(); }
  size_t NumUnknown() const;

  std::shared_ptr<const TileSeam> Seam(uint32_t tile) const;

  // From now on seams of all tiles are held once they are read.
  void HoldAllSeams();

  // \param corners  in any order
  // \throw std::logic_error where there is none
  SeamCell Find(const CellKey& corners) const;

  uint8_t At(const CellKey& corners) const { return Find(corners).label; }

  // The cell across a facet of a cell.
  // \param cell  of that tile's seam
  // \throw std::logic_error where its tile has none
  SeamCell Across(uint32_t tile, const UnknownCell& cell, int facet) const;

  // What a tile has left, with these labels of its star cells; all others are
  // matter.
  TilePart ReadPart(uint32_t tile) const;

  // \pre cell.IsUnknown()
  void Set(const SeamCell& cell, uint8_t label) {
    labels_[cell.tile][cell.place] = label;
  }

 private:
  // A choice: a tile's, those of eight neighbors, and some of far vertices.
  static constexpr size_t kSeamsHeld = 12;

  const PlanVertices& plan_;
  const TileParts& parts_;
  std::vector<std::vector<uint8_t>> labels_;  // [tiles] by TileSeam::unknown
  std::vector<size_t> num_bytes_;             // [tiles] of the seams
  mutable LruCache<TileSeam> seams_{0};
};

// Cuts the cells whose labels their tiles could not determine, with the labels
// of all others fixed: tile by tile, each time with such cells of other tiles
// within twice seam_rings neighbors, which is as wide as a seam is. Each cut is
// minimal given the labels around it, so that the value of the cut of all cells
// never rises. With kAllAtOnce there is one cut: that of the whole plan, if it
// has the same labels of all other cells.
//
// \param seam_rings  TileCutOptions
// \return how many arcs the tiles on both sides tell differently; those have
//         the capacity that the tile of the cell where they begin tells
// \throw std::logic_error where a tile lacks a cell that another one has
size_t CutSeams(int seam_rings, SeamLabels* labels,
                const Progress& progress = {});

// What fixing singular vertices has made of a plan's cells: other labels, and
// four cells of one. Centroids are vertices from the plan's number of vertices
// on. Corners are in any order.
class CellChanges {
 public:
  // \param seam  the labels before
  // \pre it outlives this
  explicit CellChanges(const SeamLabels& seam)
      : seam_(seam), blocks_(seam.plan().Blocks()) {}

  const SeamLabels& seam() const { return seam_; }

  // \return the vertex at the centroid
  uint32_t Split(const CellKey& corners, const Eigen::Vector3f& centroid);
  void SetLabel(const CellKey& corners, uint8_t label);

  struct Change {
    uint32_t centroid = kNone;  // the vertex there, if the cell is split
    // Of a cell of another label than its tile or the seams give it, and of all
    // parts of cells; else kNotKnown.
    uint8_t label = kNotKnown;
  };
  Change Of(const CellKey& corners) const;

  // The tile of a vertex; a centroid is of the first tile of its cell.
  uint32_t TileOf(uint32_t vertex) const;

  size_t NumCentroids() const { return centroids_.size(); }

  // Positions of the plan's vertices and of centroids.
  // \param ids  ascending
  std::vector<Eigen::Vector3f> PositionsOf(
      const std::vector<uint32_t>& ids) const;

  // What a tile has left, with the labels of the seams and these changes:
  // labels are kMatter or kFreeSpace, and its vertices may be more.
  TilePart ReadPart(uint32_t tile) const;

 private:
  void ApplyTo(uint32_t cell, TilePart* part) const;

  const SeamLabels& seam_;
  const PlanBlocks& blocks_;
  std::unordered_map<CellKey, Change, KeyHash> changes_;
  std::unordered_set<uint32_t> vertices_;  // of all these
  std::vector<Eigen::Vector3f> centroids_;
  std::vector<uint32_t> tiles_;  // [centroids]
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
FixingReport FixPlan(FixingRule rule, bool at_once, CellChanges* changes,
                     const Progress& progress = {});

// The partner of a half-edge that two facets at its edge alone do not tell.
// Vertices are the plan's.
struct PartnerFix {
  FacetKey facet;
  uint32_t from;
  uint32_t to;
  FacetKey partner;  // {} where there is none
};

// The part of a plan's surface that belongs to one tile: the facets whose first
// vertex is of the tile.
struct TileSurface {
  std::vector<Facet> facets;      // of the plan's vertices and centroids
  std::vector<PartnerFix> fixes;  // at edges whose first vertex is of the tile
};

// The tile's part of the surface between free space and matter of a whole plan.
// All cells at a tile's vertices are in its part, so that no facet is missing
// or duplicated.
TileSurface SurfaceOf(const CellChanges& changes, uint32_t tile);

// The surface of a plan.
struct MergedSurface {
  ExtractedSurface extracted;
  std::vector<uint32_t> ids;  // [V] the plan's vertex of each, ascending; those
                              // from its number on are centroids
};

// The whole surface; facets are in the order of the tiles.
MergedSurface MergeSurface(const CellChanges& changes);

}  // namespace colmap_ext
