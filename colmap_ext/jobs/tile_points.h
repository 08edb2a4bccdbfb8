#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_ext/jobs/mesh_tiles.h"
#include "colmap_ext/options/meshing_options.h"
#include "meshing/ray_ends.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "tiles/tile_cells.h"

namespace colmap_ext {

// Points on their way from one large file to those of the tiles: they are
// appended to files of the plan's folder, which go away with the object.
class PointShares {
 public:
  // \throw FileError if the folder cannot be written
  PointShares(const std::filesystem::path& folder, size_t num_tiles);
  ~PointShares();
  PointShares(const PointShares&) = delete;
  PointShares& operator=(const PointShares&) = delete;

  // \throw FileError if the disk is full
  void Add(size_t tile, const PointCloud& cloud, size_t point);

  // All points of a tile, in their order. Its file is gone then.
  // \throw FileError
  PointCloud Take(size_t tile);

 private:
  std::filesystem::path PathOf(size_t tile) const;
  void Flush(size_t tile);

  std::filesystem::path folder_;
  size_t max_buffer_;                 // bytes
  std::vector<std::string> buffers_;  // [tiles]
};

// The points of a plan's tiles, and the ends of rays that meet no surface: what
// masks, a region and mask_background make of a cloud that is read point by
// point. As many points as a tile has are held at a time, and all ends.
class TilePoints {
 public:
  // \param plan  its folder, views, region, and as many tiles as it will have;
  //        it, tree, options and report outlive this
  // \param num_points  of the cloud
  // \param read_mask  of the views; empty: no masks
  // \param report  gets counts of points outside, ray ends, and what masks take
  //        away; num_masks is set before
  // \throw FileError if the folder cannot be written
  TilePoints(const Plan& plan, const SplitTree& tree, size_t num_points,
             const MesherOptions& options, ReadGrayImage read_mask,
             PlanReport* report);

  // The next point, half pixel put right.
  // \param point  of the cloud
  // \return its tile; nothing where it lies beyond the region
  std::optional<uint32_t> Add(const PointCloud& cloud, size_t point);

  // To be called after the last point.
  void CollectEnds();

  // The points of a tile that masks leave, with the ends there. Once a tile.
  WeightedCloud Take(size_t tile);

 private:
  PointCloud TakeMasked(size_t share);
  Region BackgroundBounds();
  void AddToTiles(const RayEnds& ends);

  const Plan& plan_;
  const SplitTree& tree_;
  const size_t num_tiles_;
  const size_t num_points_;
  const MesherOptions& options_;
  std::optional<RayEndCollector> collector_;
  ReadGrayImage read_mask_;
  PlanReport* report_;
  // Of the tiles, and as many of the points beyond the region, in their order.
  PointShares shares_;
  std::vector<RayEnds> ends_;  // [tiles]
  size_t num_added_ = 0;
};

}  // namespace colmap_ext
