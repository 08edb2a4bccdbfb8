#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "formats/atomic_file.h"
#include "mesh/triangle_mesh.h"
#include "mesh/vertex_attributes.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// PATH.vis, the per-vertex visibility beside a mesh.
std::filesystem::path VisibilityPath(const std::filesystem::path& path);

// Writes a mesh as other tools read it: binary little-endian PLY with float x,
// y, z, uchar red, green, blue (if it has colours), float confidence (if it has
// confidences) and the list uchar int vertex_index of the triangles; and beside
// it PATH.vis, which images see each vertex, in the format of fused.ply.vis.
// Both appear complete or not at all, the mesh last.
//
// \param transform  of the positions, homogeneous; they are double then, as the
//        coordinates of maps need them
// \param together  as WriteText()
// \throw FileError if they can not be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes,
               const std::optional<Eigen::Matrix4d>& transform = std::nullopt,
               AtomicFiles* together = nullptr);

// The same without visibility and confidences.
// \param colors  [V] or empty
void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors,
                      AtomicFiles* together = nullptr);

}  // namespace colmap_ext
