#include "colmap_ext/jobs/tile_points.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

constexpr size_t kAllBuffers = size_t{64} << 20;  // bytes
constexpr size_t kMinBuffer = 16384;              // bytes

// Of each point, before its views.
struct Head {
  Eigen::Vector3f position;
  uint32_t num_views;
  bool has_color;
  Color color;
};

}  // namespace

PointShares::PointShares(const std::filesystem::path& folder, size_t num_tiles)
    : folder_(folder),
      max_buffer_(std::max(kMinBuffer, kAllBuffers / num_tiles)),
      buffers_(num_tiles) {
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    std::ofstream file(PathOf(tile), std::ios::binary | std::ios::trunc);
    if (!file) {
      throw FileError(PathOf(tile), "cannot be written");
    }
  }
}

PointShares::~PointShares() {
  std::error_code error;
  for (size_t tile = 0; tile < buffers_.size(); ++tile) {
    std::filesystem::remove(PathOf(tile), error);
  }
}

std::filesystem::path PointShares::PathOf(size_t tile) const {
  return folder_ / fmt::format("tile{:05}.points.tmp", tile);
}

void PointShares::Add(size_t tile, const PointCloud& cloud, size_t point) {
  const auto views = cloud.views[point];
  const bool has_color = !cloud.colors.empty();
  const Head head = {cloud.positions[point],
                     static_cast<uint32_t>(views.size()), has_color,
                     has_color ? cloud.colors[point] : Color()};
  std::string* buffer = &buffers_[tile];
  buffer->append(reinterpret_cast<const char*>(&head), sizeof(head));
  buffer->append(reinterpret_cast<const char*>(views.data()),
                 views.size_bytes());
  if (buffer->size() >= max_buffer_) {
    Flush(tile);
  }
}

void PointShares::Flush(size_t tile) {
  std::ofstream file(PathOf(tile), std::ios::binary | std::ios::app);
  file.write(buffers_[tile].data(),
             static_cast<std::streamsize>(buffers_[tile].size()));
  file.close();
  if (!file) {
    throw FileError(PathOf(tile), "cannot be written: is the disk full?");
  }
  buffers_[tile].clear();
}

PointCloud PointShares::Take(size_t tile) {
  Flush(tile);
  PointCloud cloud;
  ByteReader reader(PathOf(tile));
  while (reader.Remaining() > 0) {
    const Head head = reader.Read<Head>("a point");
    cloud.positions.push_back(head.position);
    if (head.has_color) {
      cloud.colors.push_back(head.color);
    }
    const size_t begin = cloud.views.values.size();
    cloud.views.values.resize(begin + head.num_views);
    reader.Read(cloud.views.values.data() + begin,
                head.num_views * sizeof(uint32_t), "a point's views");
    cloud.views.EndRow();
  }
  std::error_code error;
  std::filesystem::remove(PathOf(tile), error);
  return cloud;
}

TilePoints::TilePoints(const Plan& plan, const SplitTree& tree,
                       size_t num_points, const MesherOptions& options,
                       ReadGrayImage read_mask, PlanReport* report)
    : plan_(plan),
      tree_(tree),
      num_tiles_(plan.tiles.size()),
      num_points_(num_points),
      options_(options),
      read_mask_(std::move(read_mask)),
      report_(report),
      shares_(plan.folder, plan.region ? 2 * num_tiles_ : num_tiles_),
      ends_(num_tiles_) {
  if (plan.region) {
    collector_.emplace(*plan.region, plan.views);
  }
}

std::optional<uint32_t> TilePoints::Add(const PointCloud& cloud, size_t point) {
  const size_t number = num_added_++;
  const Eigen::Vector3f& position = cloud.positions[point];
  if (collector_ && collector_->IsOutside(position)) {
    ++report_->num_outside_points;
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
    for (uint32_t view = 0; view < plan_.views.size(); ++view) {
      AddToTiles(
          BackgroundEnds(bounds, plan_.views[view], view, read_mask_(view)));
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
  AppendEnds(std::exchange(ends_[tile], {}), &weighted);
  return weighted;
}

PointCloud TilePoints::TakeMasked(size_t share) {
  PointCloud cloud = shares_.Take(share);
  if (read_mask_) {
    const MaskReport masked = MaskCloud(read_mask_, plan_.views, &cloud);
    report_->masks->num_masked_points += masked.num_masked_points;
    report_->masks->num_masked_observations += masked.num_masked_observations;
  }
  return cloud;
}

// As the mesher has it: without a region, around what masks leave.
Region TilePoints::BackgroundBounds() {
  if (plan_.region) {
    return Grow(*plan_.region, MarginOf(*plan_.region));
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
  report_->num_ray_ends += ends.size();
  for (const RayEnd& end : ends) {
    ends_[tree_.PartOf(end.position)].push_back(end);
  }
}

}  // namespace colmap_ext
