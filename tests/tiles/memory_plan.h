#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "delaunay/growing_complex.h"
#include "tests/random.h"
#include "tests/tiles/seen_scene.h"
#include "tiles/merged_plan.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_cut.h"

namespace colmap_ext {

inline void AppendRow(const Observations& from, size_t row, Observations* to) {
  to->AddRow(from[row]);
  to->is_end.push_back(from.IsEnd(row));
}

// A plan that is held whole.
class MemoryPlan : public PlanVertices {
 public:
  // Adds a tile, its vertices as they come.
  void Add(const std::vector<Eigen::Vector3f>& positions,
           const Observations& observations) {
    AddTile(positions, observations, &blocks_);
    positions_.insert(positions_.end(), positions.begin(), positions.end());
    for (size_t row = 0; row < observations.size(); ++row) {
      AppendRow(observations, row, &observations_);
    }
  }

  const PlanBlocks& Blocks() const override { return blocks_; }
  std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                             uint32_t end) const override {
    return {positions_.begin() + begin, positions_.begin() + end};
  }
  Observations ReadObservations(uint32_t begin, uint32_t end) const override {
    Observations read;
    for (uint32_t row = begin; row < end; ++row) {
      AppendRow(observations_, row, &read);
    }
    return read;
  }

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
inline MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points,
                         size_t num_tiles,
                         const Observations& observations = {}) {
  Observations of_points = observations;
  of_points.offsets.resize(points.size() + 1, of_points.values.size());
  std::vector<uint32_t> representatives;
  std::vector<uint32_t> sorted = DistinctPoints(points, &representatives);
  std::ranges::stable_sort(sorted, {},
                           [&](uint32_t point) { return points[point].x(); });
  MemoryPlan plan;
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    const std::span<const uint32_t> share(
        sorted.data() + sorted.size() * tile / num_tiles,
        sorted.data() + sorted.size() * (tile + 1) / num_tiles);
    std::vector<Eigen::Vector3f> positions;
    for (const uint32_t point : share) {
      positions.push_back(points[point]);
    }
    std::vector<Eigen::Vector3f> along_curve;
    Observations of_tile;
    for (const uint32_t i : DistinctPoints(positions, &representatives)) {
      along_curve.push_back(positions[i]);
      AppendRow(of_points, share[i], &of_tile);
    }
    plan.Add(along_curve, of_tile);
  }
  return plan;
}
inline MemoryPlan PlanOf(const SeenScene& scene, size_t num_tiles) {
  return PlanOf(scene.points, num_tiles, scene.observations);
}

// The parts of all tiles of a plan, made at once.
class MemoryParts : public TileParts {
 public:
  MemoryParts(const SeenScene& scene, const MemoryPlan& plan) {
    for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
      TileCut cut = CutTile(plan, tile, scene.centers, scene.options);
      seams_.push_back(SeamOf(cut));
      parts_.push_back({std::move(cut.tile), std::move(cut.labels.known)});
      parts_.back().tile.tetrahedra.points.assign(parts_.back().tile.ids.size(),
                                                  Eigen::Vector3f::Zero());
      graphs_.push_back(std::move(cut.graph));
    }
  }

  TileSeam ReadSeam(uint32_t tile) const override { return seams_[tile]; }
  TilePart ReadPart(uint32_t tile) const override { return parts_[tile]; }
  PartVertices ReadVertices(uint32_t tile) const override {
    return {parts_[tile].tile.ids, parts_[tile].tile.tetrahedra.vertex_cells};
  }
  uint32_t NumCells(uint32_t tile) const override {
    return static_cast<uint32_t>(parts_[tile].labels.size());
  }
  PartCells ReadCells(uint32_t tile, uint32_t begin,
                      uint32_t end) const override {
    const auto range = [&](const auto& values) {
      using Values = std::decay_t<decltype(values)>;
      return Values(values.begin() + begin, values.begin() + end);
    };
    return {range(parts_[tile].tile.tetrahedra.cells),
            range(parts_[tile].labels), range(graphs_[tile])};
  }

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
             std::optional<FixingRule> rule = {})
      : plan(PlanOf(scene, num_tiles)),
        parts(scene, plan),
        seam(plan, parts),
        changes(seam) {
    const int seam_rings = scene.options.seam_rings;
    num_contradictions = CutSeams(seam_rings, &seam);
    if (rule) {
      report = FixPlan(*rule, seam_rings == kAllAtOnce, &changes);
    }
  }
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
  WholeCut(const SeenScene& scene, const MemoryPlan& plan) {
    std::vector<uint32_t> numbers = Iota(plan.positions().size());
    GrowingComplex complex;
    complex.points = plan.positions();
    InsertPoints(InsertionOrder(numbers.size()), {}, &complex);
    tetrahedra = TakeTetrahedra(numbers, &complex);
    graph = ZeroCapacities(tetrahedra);
    AddQualityWeights(tetrahedra, scene.options.quality_regularization, &graph);
    VisibilityWeightOptions rays = scene.options.rays;
    rays.inner_place = plan.Blocks().Center();
    AddVisibilityWeights(tetrahedra, plan.observations(), scene.centers, rays,
                         &graph);
    labels = ComputeMinCut(NeighborsOf(tetrahedra), graph).on_source_side;
  }

  // The cells by their sorted corners.
  std::map<CellKey, uint32_t> CellsByKey() const {
    std::map<CellKey, uint32_t> cells;
    for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
      cells[Sorted(tetrahedra.cells[cell].vertices)] = cell;
    }
    return cells;
  }

  Tetrahedralization tetrahedra;
  FlowCapacities graph;
  std::vector<uint8_t> labels;
};

}  // namespace colmap_ext
