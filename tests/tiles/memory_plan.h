#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tests/tiles/seen_scene.h"
#include "tiles/merged_plan.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_cut.h"

namespace colmap_ext {

// A plan that is held whole.
class MemoryPlan : public PlanVertices {
 public:
  // Adds a tile, its vertices as they come.
  void Add(const std::vector<Eigen::Vector3f>& positions,
           const Observations& observations);

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override {
    return {positions_.begin() + begin, positions_.begin() + end};
  }
  Observations ReadObservations(uint32_t begin, uint32_t end) const override;

  const std::vector<Eigen::Vector3f>& positions() const { return positions_; }
  const Observations& observations() const { return observations_; }

 private:
  PlanBlocks blocks_;
  std::vector<Eigen::Vector3f> positions_;
  Observations observations_;
};

// Shares out points to tiles along the x axis, and puts each tile's along the
// curve. Of points at one position the first is there.
// \param observations  by points; none: nobody sees them
MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points, size_t num_tiles,
                  const Observations& observations = {});
MemoryPlan PlanOf(const SeenScene& scene, size_t num_tiles);

// The parts of all tiles of a plan, made at once.
class MemoryParts : public TileParts {
 public:
  MemoryParts(const SeenScene& scene, const MemoryPlan& plan);

  TileSeam ReadSeam(uint32_t tile) const override { return seams_[tile]; }
  TilePart ReadPart(uint32_t tile) const override { return parts_[tile]; }
  PartVertices ReadVertices(uint32_t tile) const override {
    return {parts_[tile].tile.ids, parts_[tile].tile.tetrahedra.vertex_cells};
  }
  uint32_t NumCells(uint32_t tile) const override {
    return static_cast<uint32_t>(parts_[tile].labels.size());
  }
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override;

  void SetSeam(uint32_t tile, const TileSeam& seam) { seams_[tile] = seam; }

 private:
  std::vector<TileSeam> seams_;
  std::vector<TilePart> parts_;
  std::vector<FlowCapacities> graphs_;
};

// A plan whose tiles are done, cut along the seams and fixed.
struct MergedPlan {
  // \param rule  none: singular vertices are left
  MergedPlan(const SeenScene& scene, size_t num_tiles,
             std::optional<FixingRule> rule = {});
  MergedPlan(const MergedPlan&) = delete;

  MemoryPlan plan;
  MemoryParts parts;
  SeamLabels seam;
  CellChanges changes;
  size_t num_contradictions = 0;
  FixingReport report;
};

// All vertices of a plan on one machine, in the plan's order.
struct WholeCut {
  WholeCut(const SeenScene& scene, const MemoryPlan& plan);

  // The cells by their sorted corners.
  std::map<CellKey, uint32_t> CellsByKey() const;

  Tetrahedralization tetrahedra;
  FlowCapacities graph;
  std::vector<uint8_t> labels;
};

}  // namespace colmap_ext
