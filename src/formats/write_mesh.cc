#include "formats/write_mesh.h"

#include <compare>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/indices.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

// What a PLY file of a mesh holds. Empty columns are left out.
struct PlyMesh {
  std::span<const Eigen::Vector3f> positions;  // [V]
  std::span<const Color> colors{};             // [V] or empty
  std::span<const float> confidences{};        // [V] or empty
  std::span<const int32_t> labels{};           // [V] or empty
  std::span<const Facet> facets{};             // [F]
  std::string comments{};                      // lines of the header
  std::optional<Eigen::Matrix4d> transform{};  // of the positions
};

std::string Header(const PlyMesh& mesh) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\n{0}element vertex {1}\n"
      "property {2} x\nproperty {2} y\nproperty {2} z\n{3}{4}{5}"
      "element face {6}\nproperty list uchar int vertex_index\nend_header\n",
      mesh.comments, mesh.positions.size(), mesh.transform ? "double" : "float",
      mesh.colors.empty() ? ""
                          : "property uchar red\nproperty uchar green\n"
                            "property uchar blue\n",
      mesh.confidences.empty() ? "" : "property float confidence\n",
      mesh.labels.empty() ? "" : "property int label\n", mesh.facets.size());
}

void WritePly(const std::filesystem::path& path, const PlyMesh& mesh,
              AtomicFiles* together) {
  AtomicFiles alone;
  AtomicFile* file = (together != nullptr ? together : &alone)->Add(path);
  if (mesh.positions.size() > std::numeric_limits<int32_t>::max()) {
    throw FileError(path, "the mesh has more vertices than a PLY can index");
  }
  const std::string header = Header(mesh);
  file->Write(header.data(), header.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector3f& position = mesh.positions[i];
    if (mesh.transform) {
      const Eigen::Vector3d transformed =
          (*mesh.transform * position.cast<double>().homogeneous()).head<3>();
      file->Write(transformed.data(), 3 * sizeof(double));
    } else {
      file->Write(position.data(), 3 * sizeof(float));
    }
    if (!mesh.colors.empty()) {
      file->Write(mesh.colors[i]);
    }
    if (!mesh.confidences.empty()) {
      file->Write(mesh.confidences[i]);
    }
    if (!mesh.labels.empty()) {
      file->Write(mesh.labels[i]);
    }
  }
  for (const Facet& facet : mesh.facets) {
    file->Write(uint8_t{3});
    file->Write(facet);
  }
  alone.Commit();
}

// A vertex as the facets of one label have it.
struct LabeledVertex {
  uint32_t vertex = 0;
  int32_t label = -1;
  Color color = {};

  // NOLINTNEXTLINE(modernize-use-nullptr)
  auto operator<=>(const LabeledVertex&) const = default;
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
  SortUnique(&vertices);
  return vertices;
}

}  // namespace

std::filesystem::path VisibilityPath(const std::filesystem::path& path) {
  return path.string() + ".vis";
}

void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const VertexAttributes& attributes,
               const std::optional<Eigen::Matrix4d>& transform,
               AtomicFiles* together) {
  AtomicFiles alone;
  AtomicFiles& files = together != nullptr ? *together : alone;
  AtomicFile* visibility_file = files.Add(VisibilityPath(path));
  WritePly(path,
           {.positions = mesh.vertices,
            .colors = attributes.colors,
            .confidences = attributes.confidences,
            .facets = mesh.facets,
            .transform = transform},
           &files);
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
  WritePly(
      path,
      {.positions = mesh.vertices, .colors = colors, .facets = mesh.facets},
      together);
}

void WriteLabeledMesh(const std::filesystem::path& path,
                      const TriangleMesh& mesh, const MeshLabels& labels,
                      AtomicFiles* together) {
  const std::vector<LabeledVertex> vertices = FindVertices(mesh, labels);
  std::vector<Eigen::Vector3f> positions;
  std::vector<Color> colors;
  std::vector<int32_t> vertex_labels;
  for (const LabeledVertex& vertex : vertices) {
    positions.push_back(mesh.vertices[vertex.vertex]);
    colors.push_back(vertex.color);
    vertex_labels.push_back(vertex.label);
  }
  std::vector<Facet> facets = mesh.facets;
  for (size_t i = 0; i < facets.size(); ++i) {
    for (uint32_t& vertex : facets[i]) {
      const LabeledVertex wanted{vertex, labels.labels[i], labels.colors[i]};
      vertex = IndexOf(vertices, wanted);
    }
  }
  std::string comments;
  for (size_t i = 0; i < labels.names.size(); ++i) {
    comments += fmt::format("comment label {}: {}\n", i, labels.names[i]);
  }
  WritePly(path,
           {.positions = positions,
            .colors = colors,
            .labels = vertex_labels,
            .facets = facets,
            .comments = comments},
           together);
}

}  // namespace colmap_ext
