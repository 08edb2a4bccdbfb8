#include "tests/tiles/memory_plan.h"

#include <algorithm>
#include <span>

#include "delaunay/insert_points.h"

namespace colmap_ext {

void MemoryPlan::Add(const std::vector<Eigen::Vector3f>& positions,
                     const Observations& observations) {
  AddTile(positions, observations, &blocks_);
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  for (size_t row = 0; row + 1 < observations.offsets.size(); ++row) {
    for (uint64_t k = observations.offsets[row];
         k < observations.offsets[row + 1]; ++k) {
      observations_.views.push_back(observations.views[k]);
      observations_.alphas.push_back(observations.alphas[k]);
    }
    observations_.offsets.push_back(observations_.size());
    observations_.is_end.push_back(observations.IsEnd(row));
  }
}

std::vector<Eigen::Vector3f> MemoryPlan::ReadPositions(uint32_t begin,
                                                       uint32_t end) const {
  return {positions_.begin() + begin, positions_.begin() + end};
}

Observations MemoryPlan::ReadObservations(uint32_t begin, uint32_t end) const {
  Observations read;
  for (uint32_t row = begin; row < end; ++row) {
    for (uint64_t k = observations_.offsets[row];
         k < observations_.offsets[row + 1]; ++k) {
      read.views.push_back(observations_.views[k]);
      read.alphas.push_back(observations_.alphas[k]);
    }
    read.offsets.push_back(read.size());
    read.is_end.push_back(observations_.IsEnd(row));
  }
  return read;
}

MemoryPlan PlanOf(const std::vector<Eigen::Vector3f>& points, size_t num_tiles,
                  const Observations& observations) {
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
      const uint32_t point = share[i];
      if (observations.size() > 0) {
        for (uint64_t k = observations.offsets[point];
             k < observations.offsets[point + 1]; ++k) {
          of_tile.views.push_back(observations.views[k]);
          of_tile.alphas.push_back(observations.alphas[k]);
        }
      }
      of_tile.offsets.push_back(of_tile.size());
      of_tile.is_end.push_back(observations.IsEnd(point));
    }
    plan.Add(along_curve, of_tile);
  }
  return plan;
}

}  // namespace colmap_ext
