#include "formats/write_mesh.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "formats/errors.h"

namespace colmap_ext {

namespace {

using Transform = std::optional<Eigen::Matrix4d>;

// What the header of a mesh's file says.
struct MeshLayout {
  size_t num_vertices = 0;
  size_t num_facets = 0;
  bool has_colors = false;
  bool has_confidences = false;
  bool is_double = false;
};

std::string Header(const MeshLayout& layout) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {1}\n"
      "property {0} x\nproperty {0} y\nproperty {0} z\n{2}{3}"
      "element face {4}\nproperty list uchar int vertex_index\nend_header\n",
      layout.is_double ? "double" : "float", layout.num_vertices,
      layout.has_colors
          ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
          : "",
      layout.has_confidences ? "property float confidence\n" : "",
      layout.num_facets);
}

void WritePosition(const Eigen::Vector3f& position, const Transform& transform,
                   AtomicFile* file) {
  if (!transform) {
    file->Write(position.data(), 3 * sizeof(float));
    return;
  }
  const Eigen::Vector3d transformed =
      (*transform * position.cast<double>().homogeneous()).head<3>();
  file->Write(transformed.data(), 3 * sizeof(double));
}

void WriteHeader(const std::filesystem::path& path, const MeshLayout& layout,
                 AtomicFile* file) {
  if (layout.num_vertices > std::numeric_limits<int32_t>::max()) {
    throw FileError(path, "the mesh has more vertices than a PLY can index");
  }
  const std::string header = Header(layout);
  file->Write(header.data(), header.size());
}

void WriteVertices(const std::vector<Eigen::Vector3f>& positions,
                   const std::vector<Color>& colors,
                   const std::vector<float>& confidences,
                   const Transform& transform, AtomicFile* file) {
  for (size_t i = 0; i < positions.size(); ++i) {
    WritePosition(positions[i], transform, file);
    if (!colors.empty()) {
      file->Write(colors[i]);
    }
    if (!confidences.empty()) {
      file->Write(confidences[i]);
    }
  }
}

void WriteFacets(const std::vector<Facet>& facets, AtomicFile* file) {
  for (const Facet& facet : facets) {
    file->Write(uint8_t{3});
    file->Write(facet);
  }
}

}  // namespace

std::filesystem::path VisibilityPath(const std::filesystem::path& path) {
  return path.string() + ".vis";
}

void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes, const Transform& transform,
               AtomicFiles* together) {
  AtomicFiles alone;
  AtomicFiles& files = together != nullptr ? *together : alone;
  AtomicFile* visibility_file = files.Add(VisibilityPath(path));
  AtomicFile* mesh_file = files.Add(path);
  WriteHeader(
      path,
      {mesh.vertices.size(), mesh.facets.size(), !attributes.colors.empty(),
       !attributes.confidences.empty(), transform.has_value()},
      mesh_file);
  WriteVertices(mesh.vertices, attributes.colors, attributes.confidences,
                transform, mesh_file);
  WriteFacets(mesh.facets, mesh_file);
  visibility_file->Write(uint64_t{mesh.vertices.size()});
  for (size_t i = 0; i < attributes.views.size(); ++i) {
    const auto views = attributes.views[i];
    visibility_file->Write(static_cast<uint32_t>(views.size()));
    visibility_file->Write(views.data(), views.size_bytes());
  }
  alone.Commit();
}

void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors, AtomicFiles* together) {
  AtomicFiles alone;
  AtomicFile* file = (together != nullptr ? together : &alone)->Add(path);
  WriteHeader(path, {mesh.vertices.size(), mesh.facets.size(), !colors.empty()},
              file);
  WriteVertices(mesh.vertices, colors, {}, std::nullopt, file);
  WriteFacets(mesh.facets, file);
  alone.Commit();
}

}  // namespace colmap_ext
