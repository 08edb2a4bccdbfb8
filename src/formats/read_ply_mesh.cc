#include "formats/read_ply_mesh.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/index_limit.h"
#include "formats/read_ply_cloud.h"

namespace colmap_ext {
namespace {

bool IsCornerList(const PlyProperty& property) {
  return property.is_list &&
         (property.name == "vertex_index" || property.name == "vertex_indices");
}

Facet ReadFacet(const PlyProperty& list, uint64_t face, PlyReader* reader) {
  const uint64_t num_corners = reader->ReadLength(list);
  if (num_corners != 3) {
    reader->Throw(
        fmt::format("face {} has {} corners, but only triangles are read; "
                    "triangulate the mesh first",
                    face, num_corners));
  }
  Facet facet;
  for (uint32_t& corner : facet) {
    const double vertex = reader->Read(list.type);
    if (!(vertex >= 0 && vertex <= 4294967295.0) ||
        vertex != static_cast<double>(static_cast<uint32_t>(vertex))) {
      reader->Throw(fmt::format(
          "damaged: face {} has a corner that is no vertex's index", face));
    }
    corner = static_cast<uint32_t>(vertex);
  }
  return facet;
}

std::vector<Facet> ReadFacets(const PlyElement& element, PlyReader* reader) {
  std::vector<Facet> facets;
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (IsCornerList(property)) {
        facets.push_back(ReadFacet(property, i, reader));
      } else {
        reader->Skip(property);
      }
    }
    if (facets.size() != i + 1) {
      reader->Throw(
          "its faces do not have one list vertex_index or vertex_indices");
    }
  }
  return facets;
}

void CheckFacets(const TriangleMesh& mesh, const PlyReader& reader) {
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      if (vertex >= mesh.vertices.size()) {
        reader.Throw(
            fmt::format("damaged: face {} has vertex {}, but there are {}", i,
                        vertex, mesh.vertices.size()));
      }
    }
  }
}

// Of comments "label N: NAME".
std::vector<std::string> LabelNames(const std::vector<std::string>& comments) {
  std::vector<std::string> names;
  for (const std::string& comment : comments) {
    const std::string start = fmt::format("label {}: ", names.size());
    if (comment.starts_with(start)) {
      names.push_back(comment.substr(start.size()));
    }
  }
  return names;
}

// Those of their first corners: vertices are there once for each label.
std::vector<int32_t> FacetLabelsOf(const std::vector<Facet>& facets,
                                   const std::vector<int32_t>& vertex_labels) {
  std::vector<int32_t> labels;
  for (size_t i = 0; !vertex_labels.empty() && i < facets.size(); ++i) {
    labels.push_back(vertex_labels[facets[i][0]]);
  }
  return labels;
}

}  // namespace

ColoredMesh ReadColoredPlyMesh(const std::filesystem::path& path) {
  PlyReader reader(path, "the mesh");
  ColoredMesh read;
  read.label_names = LabelNames(reader.Comments());
  std::vector<int32_t> vertex_labels;
  TriangleMesh& mesh = read.mesh;
  for (const PlyElement& element : reader.Elements()) {
    reader.ExpectRoomFor(
        element, element.name == "face" ? kMaxIndexed / 3 : kMaxIndexed);
    if (element.name == "vertex") {
      PlyCloud vertices = ReadPlyVertices(element, &reader);
      mesh.vertices = std::move(vertices.positions);
      read.colors = std::move(vertices.colors);
      read.confidences = std::move(vertices.confidences);
      read.normals = std::move(vertices.normals);
      vertex_labels = std::move(vertices.labels);
    } else if (element.name == "face") {
      mesh.facets = ReadFacets(element, &reader);
    } else {
      reader.Skip(element);
    }
  }
  if (mesh.vertices.empty()) {
    reader.Throw("it has no vertices");
  }
  CheckFacets(mesh, reader);
  read.labels = FacetLabelsOf(mesh.facets, vertex_labels);
  return read;
}

TriangleMesh ReadPlyMesh(const std::filesystem::path& path) {
  return ReadColoredPlyMesh(path).mesh;
}

}  // namespace colmap_ext
