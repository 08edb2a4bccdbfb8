#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "formats/read_ply_cloud.h"
#include "formats/read_visibility.h"

namespace colmap_ext {

// Points that follow each other in a cloud, and the images that see them.
struct CloudPiece {
  PlyCloud cloud;
  Visibility visibility;
};

// How many points a PLY file has.
// \throw FileError as ReadPlyCloud()
uint64_t CountPlyVertices(const std::filesystem::path& path);

// Reads a cloud and its .vis piece by piece, without ever holding more.
// \param visit  gets each piece, of max_points but the last
// \throw FileError as ReadPlyCloud() and ReadVisibility()
void StreamCloud(const std::filesystem::path& path,
                 const std::filesystem::path& visibility_path,
                 size_t max_points,
                 const std::function<void(CloudPiece piece)>& visit);

}  // namespace colmap_ext
