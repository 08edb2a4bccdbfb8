#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/index_limit.h"
#include "base/lru_cache.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// A cell whose label its tile could not determine, or that tiles share.
struct SeamCell {
  uint8_t label;
  uint32_t tile;   // that it belongs to
  uint32_t place;  // in TileSeam::unknown; kNone: label is known

  bool IsUnknown() const { return place != kNone; }
};

// The labels of these cells. Holds a byte for each cell of unknown label, and
// the seams of the tiles that were read last.
class SeamLabels {
 public:
  // Starts with the labels that the tiles guess.
  // \pre both outlive it
  SeamLabels(const PlanBlocks& blocks, const TileParts& parts);

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

  // \pre cell.IsUnknown()
  void Set(const SeamCell& cell, uint8_t label) {
    labels_[cell.tile][cell.place] = label;
  }

 private:
  // A choice: a tile's, those of eight neighbors, and some of far vertices.
  static constexpr size_t kSeamsHeld = 12;

  const PlanBlocks& blocks_;
  const TileParts& parts_;
  std::vector<std::vector<uint8_t>> labels_;  // [tiles] by TileSeam::unknown
  std::vector<size_t> num_bytes_;             // [tiles] of the seams
  mutable LruCache<TileSeam> seams_{0};
};

// Gives labels to all star cells; all other cells are matter.
// \param labels [cells] TilePart::labels
// \throw std::logic_error where a label is missing
void ApplySeamLabels(const SeamLabels& seam, const TileTetrahedra& tile,
                     std::vector<uint8_t>* labels);

// Cuts the cells whose labels their tiles could not determine, with the labels
// of all others fixed: tile by tile, each time with such cells of other tiles
// within twice seam_rings neighbors, which is as wide as a seam is. Each cut is
// minimal given the labels around it, so that the value of the cut of all cells
// never rises. With kAllAtOnce there is one cut: that of the whole plan, if it
// has the same labels of all other cells.
//
// \param seam_rings  TileCutOptions
// \return how many arcs the tiles on both sides tell differently; those have
// the
//         capacity that the tile of the cell where they begin tells
// \throw std::logic_error where a tile lacks a cell that another one has
size_t CutSeams(int seam_rings, SeamLabels* labels,
                const Progress& progress = {});

}  // namespace colmap_ext
