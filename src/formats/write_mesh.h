#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/atomic_file.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
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
// \throw FileError if they cannot be written.
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

// A label of each facet, what it means and how it is drawn.
struct MeshLabels {
  std::vector<int32_t> labels;     // [F] index into names, -1: none
  std::vector<Color> colors;       // [F]
  std::vector<std::string> names;  // of the labels, one line each
};

// Writes a mesh with labelled facets: binary PLY whose vertices have uchar red,
// green, blue and the int label of the facets around them, and are there once
// for each of these labels; comments "label N: NAME" name the labels. Faces
// have no properties of their own, which COLMAP 4 does not read. Facets keep
// their order; vertices of no facet are left out.
// \param together  as WriteText()
// \throw FileError if it cannot be written.
void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels,
                      AtomicFiles* together = nullptr);

}  // namespace colmap_ext
