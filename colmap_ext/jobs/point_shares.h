#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// Points on their way from one large file to those of the tiles: they are
// appended to files of the plan's folder, which go away with the object.
class PointShares {
 public:
  // \throw FileError if the folder can not be written
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

}  // namespace colmap_ext
