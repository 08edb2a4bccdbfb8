#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "formats/ply_reader.h"
#include "formats/read_visibility.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

struct PlyCloud {
  std::vector<Eigen::Vector3f> positions;  // [P], may be NaN or infinite
  std::vector<Eigen::Vector3f> normals;    // [P] or empty
  std::vector<Color> colors;               // [P] or empty
  std::vector<float> confidences{};        // [P] in [0, 1] or empty
  std::vector<int32_t> labels{};           // [P] or empty; -1: none
};

// Reads the vertices of a PLY file: ASCII or binary of either byte order, the
// properties in any order and of any numeric type; colours are taken if they
// are uchar, confidences if they are float or double, the property label if it
// is int. Other properties, lists, and elements are skipped.
//
// COLMAP's reader (util/ply) is not used, as it aborts on what it does
// not expect and trusts counts, and none is packaged apart from libraries that
// bring a mesh type or more along.
//
// \throw FileError if the file is missing, truncated, or not such a PLY, or if
//        it has more points than 32-bit indices can number. Never allocates
//        more than the file's size justifies.
PlyCloud ReadPlyCloud(const std::filesystem::path& path);

// Reads the vertices where the reader has come to them.
// \throw FileError if they have no x, y, z, or are truncated or damaged.
PlyCloud ReadPlyVertices(const PlyElement& vertex, PlyReader* reader);

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
