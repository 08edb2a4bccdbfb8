#include "formats/write_mesh.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {

namespace {

std::string Header(const TriangleMesh& mesh, bool has_colors,
                   bool has_confidences) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n{}{}"
      "element face {}\nproperty list uchar int vertex_index\nend_header\n",
      mesh.vertices.size(),
      has_colors
          ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
          : "",
      has_confidences ? "property float confidence\n" : "", mesh.facets.size());
}

void WritePly(const TriangleMesh& mesh, const std::vector<Color>& colors,
              const std::vector<float>& confidences, AtomicFile* file) {
  const std::string header =
      Header(mesh, !colors.empty(), !confidences.empty());
  file->Write(header.data(), header.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    file->Write(mesh.vertices[i].data(), 3 * sizeof(float));
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
               const VertexAttributes& attributes) {
  CheckSize(path, mesh);
  AtomicFile visibility_file(VisibilityPath(path));
  AtomicFile mesh_file(path);
  WriteVisibility(attributes, &visibility_file);
  WritePly(mesh, attributes.colors, attributes.confidences, &mesh_file);
  AtomicFile* const files[] = {&visibility_file, &mesh_file};
  Commit(files);
}

void WriteColoredMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh,
                      const std::vector<Color>& colors) {
  CheckSize(path, mesh);
  AtomicFile file(path);
  WritePly(mesh, colors, {}, &file);
  AtomicFile* const files[] = {&file};
  Commit(files);
}

}  // namespace colmap_ext
