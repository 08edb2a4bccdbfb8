#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext::synthetic {

// A mesh as a PLY file holds it, its polygons cut into triangles; a point cloud
// is one without facets.
struct PlyMesh {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3f> normals;  // [V] or empty
  std::vector<Color> colors;             // [V] or empty
  std::vector<int32_t> labels;           // [F] or empty, the property `label`
                                         // of facets or of their vertices
};

// Reads a PLY file in any of its three formats, whatever else it holds.
// \throw std::runtime_error for what is not a PLY file, ends early, or has
//        facets of vertices that are not there.
PlyMesh ReadPlyMesh(const std::string& path);

// Writes a binary little-endian PLY file, with facets where there are any.
// \throw std::runtime_error where the file cannot be written.
void WritePlyMesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace colmap_ext::synthetic
