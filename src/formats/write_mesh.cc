#include "formats/write_mesh.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {

namespace {

using Transform = std::optional<Eigen::Matrix4d>;

std::string Header(const MeshLayout& layout) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {1}\n"
      "property {0} x\nproperty {0} y\nproperty {0} z\n{2}{3}"
      "element face {4}\nproperty list uchar int vertex_index\nend_header\n",
      layout.transform ? "double" : "float", layout.num_vertices,
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

MeshWriter::MeshWriter(const std::filesystem::path& path,
                       const MeshLayout& layout)
    : transform_(layout.transform),
      visibility_file_(VisibilityPath(path)),
      mesh_file_(path) {
  WriteHeader(path, layout, &mesh_file_);
  visibility_file_.Write(uint64_t{layout.num_vertices});
}

void MeshWriter::AddVertices(const std::vector<Eigen::Vector3f>& positions,
                             const VertexAttributes& attributes) {
  WriteVertices(positions, attributes.colors, attributes.confidences,
                transform_, &mesh_file_);
  for (size_t i = 0; i < attributes.views.size(); ++i) {
    const auto views = attributes.views[i];
    visibility_file_.Write(static_cast<uint32_t>(views.size()));
    visibility_file_.Write(views.data(), views.size_bytes());
  }
}

void MeshWriter::AddFacets(const std::vector<Facet>& facets) {
  WriteFacets(facets, &mesh_file_);
}

void MeshWriter::Commit() {
  AtomicFile* const files[] = {&visibility_file_, &mesh_file_};
  colmap_ext::Commit(files);
}

void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes, const Transform& transform) {
  MeshWriter writer(path, {mesh.vertices.size(), mesh.facets.size(),
                           !attributes.colors.empty(),
                           !attributes.confidences.empty(), transform});
  writer.AddVertices(mesh.vertices, attributes);
  writer.AddFacets(mesh.facets);
  writer.Commit();
}

void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors) {
  AtomicFile file(path);
  WriteHeader(path,
              {mesh.vertices.size(), mesh.facets.size(), !colors.empty(), false,
               std::nullopt},
              &file);
  WriteVertices(mesh.vertices, colors, {}, std::nullopt, &file);
  WriteFacets(mesh.facets, &file);
  AtomicFile* const files[] = {&file};
  Commit(files);
}

}  // namespace colmap_ext
