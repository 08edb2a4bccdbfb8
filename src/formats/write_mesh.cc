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

std::string Header(const TriangleMesh& mesh, bool is_double, bool has_colors,
                   bool has_confidences) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {1}\n"
      "property {0} x\nproperty {0} y\nproperty {0} z\n{2}{3}"
      "element face {4}\nproperty list uchar int vertex_index\nend_header\n",
      is_double ? "double" : "float", mesh.vertices.size(),
      has_colors
          ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
          : "",
      has_confidences ? "property float confidence\n" : "", mesh.facets.size());
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

void WritePly(const TriangleMesh& mesh, const std::vector<Color>& colors,
              const std::vector<float>& confidences, const Transform& transform,
              AtomicFile* file) {
  const std::string header = Header(mesh, transform.has_value(),
                                    !colors.empty(), !confidences.empty());
  file->Write(header.data(), header.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    WritePosition(mesh.vertices[i], transform, file);
    if (!colors.empty()) {
      file->Write(colors[i]);
    }
    if (!confidences.empty()) {
      file->Write(confidences[i]);
    }
  }
  for (const Facet& facet : mesh.facets) {
    file->Write(uint8_t{3});
    file->Write(facet);
  }
}

void WriteVisibility(const VertexAttributes& attributes, AtomicFile* file) {
  file->Write(uint64_t{attributes.views.size()});
  for (size_t i = 0; i < attributes.views.size(); ++i) {
    const auto views = attributes.views[i];
    file->Write(static_cast<uint32_t>(views.size()));
    file->Write(views.data(), views.size_bytes());
  }
}

void CheckSize(const std::filesystem::path& path, const TriangleMesh& mesh) {
  if (mesh.vertices.size() > std::numeric_limits<int32_t>::max()) {
    throw FileError(path, "the mesh has more vertices than a PLY can index");
  }
}

}  // namespace

std::filesystem::path VisibilityPath(const std::filesystem::path& path) {
  return path.string() + ".vis";
}

void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes, const Transform& transform) {
  CheckSize(path, mesh);
  AtomicFile visibility_file(VisibilityPath(path));
  AtomicFile mesh_file(path);
  WriteVisibility(attributes, &visibility_file);
  WritePly(mesh, attributes.colors, attributes.confidences, transform,
           &mesh_file);
  AtomicFile* const files[] = {&visibility_file, &mesh_file};
  Commit(files);
}

void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors) {
  CheckSize(path, mesh);
  AtomicFile file(path);
  WritePly(mesh, colors, {}, std::nullopt, &file);
  AtomicFile* const files[] = {&file};
  Commit(files);
}

}  // namespace colmap_ext
