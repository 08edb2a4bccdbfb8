#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/read_visibility.h"
#include "mesh/triangle_mesh.h"
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

// Reads a triangle mesh, or a point cloud, which is one without facets, from a
// PLY file: ASCII or binary of either byte order, numbers of any type, faces as
// the list vertex_index or vertex_indices. Other properties and elements are
// skipped. Vertices may be NaN or infinite.
//
// \throw FileError if the file is missing, truncated, or not such a PLY; if it
//        has no vertices, or more vertices or half-edges than 32-bit indices
//        can number; if a face has not three corners, or a vertex that is
//        not there.
TriangleMesh ReadPlyMesh(const std::filesystem::path& path);

struct ColoredMesh {
  TriangleMesh mesh;
  std::vector<Color> colors;             // [V] or empty
  std::vector<float> confidences;        // [V] in [0, 1] or empty
  std::vector<Eigen::Vector3f> normals;  // [V] or empty
  std::vector<int32_t> labels;           // [F] or empty; -1: none
  std::vector<std::string> label_names;  // of the labels, as far as the file
                                         // names them
};

// The same with the vertices' colours, if they have uchar ones, their
// confidences, if they have float or double ones, clamped to [0, 1], their
// normals, and the facets' labels as WriteLabeledMesh() writes them.
ColoredMesh ReadColoredPlyMesh(const std::filesystem::path& path);

}  // namespace colmap_ext
