#include "formats/write_labeled_mesh.h"

#include <fmt/format.h>

#include "formats/atomic_file.h"

namespace colmap_ext {

namespace {

std::string Header(const TriangleMesh& mesh,
                   const std::vector<std::string>& names) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (size_t i = 0; i < names.size(); ++i) {
    header += fmt::format("comment label {}: {}\n", i, names[i]);
  }
  return header +
         fmt::format(
             "element vertex {}\nproperty float x\nproperty float y\n"
             "property float z\nelement face {}\n"
             "property list uchar int vertex_index\nproperty uchar red\n"
             "property uchar green\nproperty uchar blue\n"
             "property int label\nend_header\n",
             mesh.vertices.size(), mesh.facets.size());
}

}  // namespace

void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels) {
  AtomicFile file(path);
  const std::string header = Header(mesh, labels.names);
  file.Write(header.data(), header.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    file.Write(vertex.data(), 3 * sizeof(float));
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    file.Write(uint8_t{3});
    file.Write(mesh.facets[i]);
    file.Write(labels.colors[i]);
    file.Write(labels.labels[i]);
  }
  AtomicFile* const files[] = {&file};
  Commit(files);
}

}  // namespace colmap_ext
