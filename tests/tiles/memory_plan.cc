#include "tests/tiles/memory_plan.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "delaunay/cell_graph.h"
#include "delaunay/growing_complex.h"

namespace colmap_ext {
namespace {

void AppendRow(const Observations& from, size_t row, Observations* to) {
  to->AddRow(from[row]);
  to->is_end.push_back(from.IsEnd(row));
}

}  // namespace

void MemoryPlan::Add(const std::vector<Eigen::Vector3f>& positions,
                     const Observations& observations) {
  AddTile(positions, observations, &blocks_);
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  for (size_t row = 0; row < observations.size(); ++row) {
    AppendRow(observations, row, &observations_);
  }
}

Observations MemoryPlan::ReadObservations(uint32_t begin, uint32_t end) const {
  Observations read;
  for (uint32_t row = begin; row < end; ++row) {
    AppendRow(observations_, row, &read);
  }
  return read;
}

MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points, size_t num_tiles,
                  const Observations& observations) {
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

MemoryPlan PlanOf(const SeenScene& scene, size_t num_tiles) {
  return PlanOf(scene.points, num_tiles, scene.observations);
}

MemoryParts::MemoryParts(const SeenScene& scene, const MemoryPlan& plan) {
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    TileCut cut = CutTile(plan, tile, scene.centers, scene.options);
    seams_.push_back(SeamOf(cut));
    parts_.push_back({std::move(cut.tile), std::move(cut.labels.known)});
    parts_.back().tile.tetrahedra.points.assign(parts_.back().tile.ids.size(),
                                                Eigen::Vector3f::Zero());
    graphs_.push_back(std::move(cut.graph));
  }
}

PartCells MemoryParts::ReadCells(uint32_t tile, uint32_t begin,
                                 uint32_t end) const {
  const auto range = [&](const auto& values) {
    using Values = std::decay_t<decltype(values)>;
    return Values(values.begin() + begin, values.begin() + end);
  };
  return {range(parts_[tile].tile.tetrahedra.cells), range(parts_[tile].labels),
          range(graphs_[tile])};
}

MergedPlan::MergedPlan(const SeenScene& scene, size_t num_tiles,
                       std::optional<FixingRule> rule)
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

WholeCut::WholeCut(const SeenScene& scene, const MemoryPlan& plan) {
  std::vector<uint32_t> numbers(plan.positions().size());
  std::iota(numbers.begin(), numbers.end(), 0);
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

std::map<CellKey, uint32_t> WholeCut::CellsByKey() const {
  std::map<CellKey, uint32_t> cells;
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    cells[Sorted(tetrahedra.cells[cell].vertices)] = cell;
  }
  return cells;
}

}  // namespace colmap_ext
