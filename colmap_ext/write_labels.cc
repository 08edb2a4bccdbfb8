#include "colmap_ext/write_labels.h"

#include <cstdint>
#include <string>

#include "colmap_ext/atomic_file.h"
#include "colmap_ext/write_png.h"
#include "evaluation/mesh_renderer.h"

namespace colmap_ext {

namespace {

constexpr int kWidth = 1024;  // px, of the picture
constexpr int kHeight = 768;  // px

// [F] the best label, -1 for none.
std::vector<int32_t> BestLabels(const FacetLabels& labels) {
  std::vector<int32_t> best;
  for (size_t i = 0; i < labels.NumFacets(); ++i) {
    const auto row = labels.Labels(i);
    best.push_back(row.empty() ? -1 : static_cast<int32_t>(row[0]));
  }
  return best;
}

std::string Header(const TriangleMesh& mesh, const FacetLabels& labels,
                   const std::vector<View>& views) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (size_t i = 0; i < labels.pairs.size(); ++i) {
    header += "comment label " + std::to_string(i) + ": " +
              views[labels.pairs[i].first].name + " " +
              views[labels.pairs[i].second].name + "\n";
  }
  return header + "element vertex " + std::to_string(mesh.vertices.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "element face " +
         std::to_string(mesh.facets.size()) +
         "\nproperty list uchar int vertex_index\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property int label\nend_header\n";
}

}  // namespace

void WriteLabels(const std::filesystem::path& path,
                 const std::filesystem::path& picture_path,
                 const TriangleMesh& mesh, const FacetLabels& labels,
                 const std::vector<View>& views) {
  const std::vector<int32_t> best = BestLabels(labels);
  AtomicFile file(path);
  const std::string header = Header(mesh, labels, views);
  file.Write(header.data(), header.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    file.Write(vertex.data(), 3 * sizeof(float));
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    file.Write(uint8_t{3});
    file.Write(mesh.facets[i]);
    file.Write(LabelColor(best[i]));
    file.Write(best[i]);
  }
  AtomicFile* const files[] = {&file};
  Commit(files);
  const DrawnMesh drawn{mesh, {}, {}, best};
  WritePng(picture_path,
           RenderMesh(drawn, AutomaticView(drawn, kWidth, kHeight),
                      RenderMode::kLabels, 1));
}

}  // namespace colmap_ext
