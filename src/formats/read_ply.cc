#include "formats/read_ply.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/ply_reader.h"

namespace colmap_ext {
namespace {

// \throw FileError if there is none, as ByteReader does not say what it is for
const std::filesystem::path& ExpectThere(const std::filesystem::path& path,
                                         const VisibilityOwner& owner) {
  if (!std::filesystem::exists(path)) {
    throw FileError(path,
                    std::string("no such file, so it is not known which images "
                                "see the points; ") +
                        owner.what_to_do,
                    owner.alternative);
  }
  return path;
}

// Where in a vertex, as indices of its properties, are three of one type?
// \return -1 three times if one is missing.
std::array<int, 3> FindThree(const PlyElement& vertex,
                             const std::array<const char*, 3>& names,
                             std::initializer_list<PlyType> types = {}) {
  std::array<int, 3> found;
  std::ranges::transform(names, found.begin(), [&](const char* name) {
    return vertex.Find(name, types);
  });
  return std::ranges::min(found) >= 0 ? found : std::array{-1, -1, -1};
}

// In [0, 1]; what is not a number is no confidence.
float ClampConfidence(double value) {
  return value >= 0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f;
}

// Those that are no counts stand for none, as ASCII files may have any number.
int32_t ToLabel(double value) {
  return value >= 0 && value <= std::numeric_limits<int32_t>::max()
             ? static_cast<int32_t>(value)
             : -1;
}

// Cut off to [0, 255]; 0 for what is not a number, as ASCII files may say
// "nan".
uint8_t ToByte(double value) {
  return value > 0 ? static_cast<uint8_t>(std::min(value, 255.0)) : 0;
}

// Reads the vertices where the reader has come to them.
// \throw FileError if they have no x, y, z, or are truncated or damaged.
PlyCloud ReadVertices(const PlyElement& vertex, PlyReader* reader) {
  const std::array<int, 3> position = FindThree(vertex, {"x", "y", "z"});
  const std::array<int, 3> normal = FindThree(vertex, {"nx", "ny", "nz"});
  std::array<int, 3> color =
      FindThree(vertex, {"red", "green", "blue"}, {PlyType::kUint8});
  if (color[0] < 0) {
    color = FindThree(vertex, {"diffuse_red", "diffuse_green", "diffuse_blue"},
                      {PlyType::kUint8});
  }
  const int confidence =
      vertex.Find("confidence", {PlyType::kFloat32, PlyType::kFloat64});
  const int label = vertex.Find("label", {PlyType::kInt32});
  if (position[0] < 0) {
    reader->Throw("its vertices have no x, y, z");
  }
  PlyCloud cloud;
  cloud.positions.resize(vertex.count);
  cloud.normals.resize(normal[0] >= 0 ? vertex.count : 0);
  cloud.colors.resize(color[0] >= 0 ? vertex.count : 0);
  cloud.confidences.resize(confidence >= 0 ? vertex.count : 0);
  cloud.labels.resize(label >= 0 ? vertex.count : 0);
  std::vector<double> values(vertex.properties.size());
  for (uint64_t i = 0; i < vertex.count; ++i) {
    for (size_t j = 0; j < values.size(); ++j) {
      const PlyProperty& property = vertex.properties[j];
      if (property.is_list) {
        reader->Skip(property);
      } else {
        values[j] = reader->Read(property.type);
      }
    }
    for (int k = 0; k < 3; ++k) {
      cloud.positions[i][k] = static_cast<float>(values[position[k]]);
      if (normal[0] >= 0) {
        cloud.normals[i][k] = static_cast<float>(values[normal[k]]);
      }
      if (color[0] >= 0) {
        cloud.colors[i][k] = ToByte(values[color[k]]);
      }
    }
    if (confidence >= 0) {
      cloud.confidences[i] = ClampConfidence(values[confidence]);
    }
    if (label >= 0) {
      cloud.labels[i] = ToLabel(values[label]);
    }
  }
  return cloud;
}

// Reads up to the vertices.
PlyElement SkipToVertices(PlyReader* reader, uint64_t max_count = UINT64_MAX) {
  for (const PlyElement& element : reader->Elements()) {
    reader->ExpectRoomFor(element, max_count);
    if (element.name == "vertex") {
      return element;
    }
    reader->Skip(element);
  }
  reader->Throw("not a point cloud: it has no vertices");
}

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

VisibilityReader::VisibilityReader(const std::filesystem::path& path,
                                   size_t num_points,
                                   const VisibilityOwner& owner)
    : reader_(ExpectThere(path, owner)) {
  const uint64_t count = reader_.Read<uint64_t>("the number of points");
  if (count != num_points) {
    throw FileError(
        path,
        fmt::format(
            "is about {} points, but the {} has {}: was the {} edited?; {}",
            count, owner.name, num_points, owner.name, owner.what_to_do),
        owner.alternative);
  }
  if (count > reader_.Remaining() / sizeof(uint32_t)) {
    reader_.Throw(
        fmt::format("truncated or damaged: no room for {} points", count));
  }
}

void VisibilityReader::Read(size_t num_points, Visibility* visibility) {
  for (size_t i = 0; i < num_points; ++i, ++point_) {
    const uint32_t num_images = reader_.Read<uint32_t>("a point's images");
    if (num_images > reader_.Remaining() / sizeof(uint32_t)) {
      reader_.Throw(
          fmt::format("truncated or damaged: point {} promises {} images",
                      point_, num_images));
    }
    const size_t begin = visibility->values.size();
    visibility->values.resize(begin + num_images);
    reader_.Read(visibility->values.data() + begin,
                 num_images * sizeof(uint32_t), "a point's images");
    visibility->EndRow();
  }
}

Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points,
                          const VisibilityOwner& owner) {
  VisibilityReader reader(path, num_points, owner);
  Visibility visibility;
  visibility.offsets.reserve(num_points + 1);
  visibility.values.reserve(reader.RemainingBytes() / sizeof(uint32_t) -
                            num_points);
  reader.Read(num_points, &visibility);
  reader.ExpectEnd();
  return visibility;
}

PlyCloud ReadPlyCloud(const std::filesystem::path& path) {
  PlyReader reader(path, "the vertices");
  return ReadVertices(SkipToVertices(&reader, kMaxIndexed), &reader);
}

uint64_t CountPlyVertices(const std::filesystem::path& path) {
  PlyReader reader(path, "the vertices");
  return SkipToVertices(&reader).count;
}

void StreamCloud(const std::filesystem::path& path,
                 const std::filesystem::path& visibility_path,
                 size_t max_points,
                 const std::function<void(CloudPiece piece)>& visit) {
  PlyReader reader(path, "the vertices");
  PlyElement rest = SkipToVertices(&reader);
  VisibilityReader visibility(visibility_path, rest.count);
  while (rest.count > 0) {
    PlyElement piece = rest;
    piece.count = std::min<uint64_t>(rest.count, max_points);
    CloudPiece read;
    read.cloud = ReadVertices(piece, &reader);
    visibility.Read(piece.count, &read.visibility);
    rest.count -= piece.count;
    visit(std::move(read));
  }
  visibility.ExpectEnd();
}

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
      PlyCloud vertices = ReadVertices(element, &reader);
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
