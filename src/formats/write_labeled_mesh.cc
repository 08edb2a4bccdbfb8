#include "formats/write_labeled_mesh.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

namespace colmap_ext {

namespace {

// A vertex as the facets of one label have it.
struct LabeledVertex {
  uint32_t vertex = 0;
  int32_t label = -1;
  Color color = {};

  bool operator<(const LabeledVertex& other) const {
    return std::tie(vertex, label, color) <
           std::tie(other.vertex, other.label, other.color);
  }
  bool operator==(const LabeledVertex& other) const = default;
};

// Sorted, each once.
std::vector<LabeledVertex> FindVertices(const TriangleMesh& mesh,
                                        const MeshLabels& labels) {
  std::vector<LabeledVertex> vertices;
  vertices.reserve(3 * mesh.facets.size());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      vertices.push_back({vertex, labels.labels[i], labels.colors[i]});
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::string Header(size_t num_vertices, size_t num_facets,
                   const std::vector<std::string>& names) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (size_t i = 0; i < names.size(); ++i) {
    header += fmt::format("comment label {}: {}\n", i, names[i]);
  }
  return header + fmt::format(
                      "element vertex {}\nproperty float x\nproperty float y\n"
                      "property float z\nproperty uchar red\n"
                      "property uchar green\nproperty uchar blue\n"
                      "property int label\nelement face {}\n"
                      "property list uchar int vertex_index\nend_header\n",
                      num_vertices, num_facets);
}

}  // namespace

void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels,
                      AtomicFiles* together) {
  AtomicFiles alone;
  AtomicFile* file = (together != nullptr ? together : &alone)->Add(path);
  const std::vector<LabeledVertex> vertices = FindVertices(mesh, labels);
  const std::string header =
      Header(vertices.size(), mesh.facets.size(), labels.names);
  file->Write(header.data(), header.size());
  for (const LabeledVertex& vertex : vertices) {
    file->Write(mesh.vertices[vertex.vertex].data(), 3 * sizeof(float));
    file->Write(vertex.color);
    file->Write(vertex.label);
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    file->Write(uint8_t{3});
    for (const uint32_t vertex : mesh.facets[i]) {
      const auto it = std::lower_bound(
          vertices.begin(), vertices.end(),
          LabeledVertex{vertex, labels.labels[i], labels.colors[i]});
      file->Write(static_cast<int32_t>(it - vertices.begin()));
    }
  }
  alone.Commit();
}

}  // namespace colmap_ext
