#include "colmap_ext/jobs/point_shares.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kAllBuffers = size_t{64} << 20;  // bytes
constexpr size_t kMinBuffer = 16384;              // bytes

template <typename T>
void Append(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// Of each point, before its views.
struct Head {
  float position[3];
  uint32_t has_color;
  uint32_t color;
  uint32_t num_views;
};

}  // namespace

PointShares::PointShares(const std::filesystem::path& folder, size_t num_tiles)
    : folder_(folder),
      max_buffer_(std::max(kMinBuffer, kAllBuffers / num_tiles)),
      buffers_(num_tiles) {
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    std::ofstream file(PathOf(tile), std::ios::binary | std::ios::trunc);
    if (!file) {
      throw FileError(PathOf(tile), "can not be written");
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
  const Eigen::Vector3f& position = cloud.positions[point];
  Head head = {{position.x(), position.y(), position.z()},
               !cloud.colors.empty(),
               0,
               static_cast<uint32_t>(views.size())};
  if (!cloud.colors.empty()) {
    const Color& color = cloud.colors[point];
    head.color = color[0] | color[1] << 8 | color[2] << 16;
  }
  std::string* buffer = &buffers_[tile];
  Append(head, buffer);
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
    throw FileError(PathOf(tile), "can not be written: is the disk full?");
  }
  buffers_[tile].clear();
}

PointCloud PointShares::Take(size_t tile) {
  Flush(tile);
  PointCloud cloud;
  ByteReader reader(PathOf(tile));
  while (reader.Remaining() > 0) {
    const Head head = reader.Read<Head>("a point");
    cloud.positions.emplace_back(head.position);
    if (head.has_color != 0) {
      cloud.colors.push_back({static_cast<uint8_t>(head.color),
                              static_cast<uint8_t>(head.color >> 8),
                              static_cast<uint8_t>(head.color >> 16)});
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

}  // namespace colmap_ext
