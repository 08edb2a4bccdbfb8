#include "colmap_ext/jobs/tile_points.h"

#include <utility>

#include "meshing/manifold_meshing.h"

namespace colmap_ext {

TilePoints::TilePoints(const std::filesystem::path& folder,
                       const SplitTree& tree, size_t num_tiles,
                       size_t num_points, const MesherOptions& options,
                       const std::vector<View>& views, ReadGrayImage read_mask,
                       const std::optional<Region>& region)
    : tree_(tree),
      num_tiles_(num_tiles),
      num_points_(num_points),
      options_(options),
      views_(views),
      region_(region),
      read_mask_(std::move(read_mask)),
      shares_(folder, region ? 2 * num_tiles : num_tiles),
      ends_(num_tiles) {
  if (region) {
    collector_.emplace(*region, views);
  }
}

std::optional<uint32_t> TilePoints::Add(const PointCloud& cloud, size_t point) {
  const size_t number = num_added_++;
  const Eigen::Vector3f& position = cloud.positions[point];
  if (collector_ && collector_->IsOutside(position)) {
    ++num_outside_;
    shares_.Add(num_tiles_ + number * num_tiles_ / num_points_, cloud, point);
    return std::nullopt;
  }
  const uint32_t tile = tree_.PartOf(position);
  shares_.Add(tile, cloud, point);
  return tile;
}

void TilePoints::CollectEnds() {
  if (options_.mask_background) {
    const Region bounds = BackgroundBounds();
    for (uint32_t view = 0; view < views_.size(); ++view) {
      AddToTiles(BackgroundEnds(bounds, views_[view], view, read_mask_(view)));
    }
  }
  if (!collector_) {
    return;
  }
  for (size_t share = 0; share < num_tiles_; ++share) {
    const PointCloud cloud = TakeMasked(num_tiles_ + share);
    const std::vector<float> weights =
        ObservationWeights(options_.meshing, cloud);
    for (size_t i = 0; i < cloud.size(); ++i) {
      collector_->Add(cloud.positions[i], cloud.views[i], weights[i]);
    }
  }
  AddToTiles(collector_->Take());
}

WeightedCloud TilePoints::Take(size_t tile) {
  WeightedCloud weighted;
  weighted.cloud = TakeMasked(tile);
  weighted.weights = ObservationWeights(options_.meshing, weighted.cloud);
  weighted.num_points = weighted.cloud.size();
  AppendEnds(ends_[tile], &weighted);
  ends_[tile] = {};
  return weighted;
}

PointCloud TilePoints::TakeMasked(size_t share) {
  PointCloud cloud = shares_.Take(share);
  if (read_mask_) {
    const MaskReport masked = MaskCloud(read_mask_, views_, &cloud);
    masks_.num_masked_points += masked.num_masked_points;
    masks_.num_masked_observations += masked.num_masked_observations;
  }
  return cloud;
}

// As the mesher has it: without a region, around what masks leave.
Region TilePoints::BackgroundBounds() {
  if (region_) {
    return Grow(*region_, MarginOf(*region_));
  }
  Eigen::AlignedBox3f box;
  for (size_t tile = 0; tile < num_tiles_; ++tile) {
    const PointCloud cloud = TakeMasked(tile);
    for (size_t i = 0; i < cloud.size(); ++i) {
      box.extend(cloud.positions[i]);
      shares_.Add(tile, cloud, i);
    }
  }
  return RegionAround(box);
}

void TilePoints::AddToTiles(const RayEnds& ends) {
  num_ends_ += ends.size();
  for (size_t i = 0; i < ends.size(); ++i) {
    RayEnds* to = &ends_[tree_.PartOf(ends.positions[i])];
    to->positions.push_back(ends.positions[i]);
    to->views.push_back(ends.views[i]);
    to->weights.push_back(ends.weights[i]);
  }
}

}  // namespace colmap_ext
