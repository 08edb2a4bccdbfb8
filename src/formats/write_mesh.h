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

// What the header of a mesh's file says.
struct MeshLayout {
  size_t num_vertices = 0;
  size_t num_facets = 0;
  bool has_colors = false;
  bool has_confidences = false;
  // Of the positions, homogeneous; they are double then, as the coordinates of
  // maps need them.
  std::optional<Eigen::Matrix4d> transform;
};

// Writes the files of WriteMesh() bit by bit: first all vertices, then all
// facets.
class MeshWriter {
 public:
  // \throw FileError if there can be no files
  MeshWriter(const std::filesystem::path& path, const MeshLayout& layout);

  // \throw FileError if the disk is full, or fails
  void AddVertices(const std::vector<Eigen::Vector3f>& positions,
                   const VertexAttributes& attributes);
  void AddFacets(const std::vector<Facet>& facets);

  // The files appear.
  // \throw FileError if they can not
  void Commit();

 private:
  std::optional<Eigen::Matrix4d> transform_;
  AtomicFile visibility_file_;
  AtomicFile mesh_file_;
};

// Writes a mesh as other tools read it: binary little-endian PLY with float x,
// y, z, uchar red, green, blue (if it has colours), float confidence (if it has
// confidences) and the list uchar int vertex_index of the triangles; and beside
// it PATH.vis, which images see each vertex, in the format of fused.ply.vis.
// Both appear complete or not at all, the mesh last.
//
// \param transform  MeshLayout::transform
// \throw FileError if they can not be written.
void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes,
               const std::optional<Eigen::Matrix4d>& transform = std::nullopt);

// The same without visibility and confidences.
// \param colors  [V] or empty
void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors);

}  // namespace colmap_ext
