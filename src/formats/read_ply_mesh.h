#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

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
