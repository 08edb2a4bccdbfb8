#pragma once

#include <string>

#include "mesh/triangle_mesh.h"
#include "pictures/mesh_renderer.h"

namespace colmap_ext::synthetic {

// A mesh as a PLY file holds it, its polygons cut into triangles, its facets'
// property `label` as labels.
using PlyMesh = DrawnMesh;

// Reads a PLY file in any of its three formats, whatever else it holds.
// \throw std::runtime_error for what is not a PLY file, ends early, or has
//        facets of vertices that are not there.
PlyMesh ReadPlyMesh(const std::string& path);

// Writes a binary little-endian PLY file, with facets where there are any.
// \throw std::runtime_error where the file cannot be written.
void WritePlyMesh(const std::string& path, const TriangleMesh& mesh);

}  // namespace colmap_ext::synthetic
