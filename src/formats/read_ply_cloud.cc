#include "formats/read_ply_cloud.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/index_limit.h"
#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/ply_reader.h"

namespace colmap_ext {
namespace {

// Where in a vertex, as an index of its properties, are its coordinates?
struct VertexLayout {
  std::array<int, 3> position;
  std::array<int, 3> normal;
  std::array<int, 3> color;
  int confidence = -1;  // -1: none
  int label = -1;       // -1: none
  bool has_normals = false;
  bool has_colors = false;
};

VertexLayout FindLayout(const PlyElement& vertex,
                        const std::filesystem::path& path) {
  VertexLayout layout;
  const auto find = [&vertex](std::array<const char*, 3> names,
                              std::array<int, 3>* indices) {
    bool found = true;
    for (int i = 0; i < 3; ++i) {
      (*indices)[i] = vertex.Find(names[i]);
      found = found && (*indices)[i] >= 0;
    }
    return found;
  };
  if (!find({"x", "y", "z"}, &layout.position)) {
    throw FileError(path, "its vertices have no x, y, z");
  }
  layout.has_normals = find({"nx", "ny", "nz"}, &layout.normal);
  layout.has_colors =
      find({"red", "green", "blue"}, &layout.color) ||
      find({"diffuse_red", "diffuse_green", "diffuse_blue"}, &layout.color);
  for (int i = 0; layout.has_colors && i < 3; ++i) {
    layout.has_colors =
        vertex.properties[layout.color[i]].type == PlyType::kUint8;
  }
  layout.confidence = vertex.Find("confidence");
  if (layout.confidence >= 0) {
    const PlyType type = vertex.properties[layout.confidence].type;
    if (type != PlyType::kFloat32 && type != PlyType::kFloat64) {
      layout.confidence = -1;
    }
  }
  layout.label = vertex.Find("label");
  if (layout.label >= 0 &&
      vertex.properties[layout.label].type != PlyType::kInt32) {
    layout.label = -1;
  }
  return layout;
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

// Reads up to the vertices.
PlyElement SkipToVertices(const PlyHeader& header,
                          const std::filesystem::path& path,
                          PlyNumberReader* numbers,
                          uint64_t max_count = UINT64_MAX) {
  for (const PlyElement& element : header.elements) {
    numbers->ExpectRoomFor(element, max_count);
    if (element.name == "vertex") {
      return element;
    }
    numbers->Skip(element);
  }
  throw FileError(path, "not a point cloud: it has no vertices");
}

}  // namespace

PlyCloud ReadPlyVertices(const PlyElement& vertex,
                         const std::filesystem::path& path,
                         PlyNumberReader* numbers) {
  const VertexLayout layout = FindLayout(vertex, path);
  PlyCloud cloud;
  cloud.positions.resize(vertex.count);
  cloud.normals.resize(layout.has_normals ? vertex.count : 0);
  cloud.colors.resize(layout.has_colors ? vertex.count : 0);
  cloud.confidences.resize(layout.confidence >= 0 ? vertex.count : 0);
  cloud.labels.resize(layout.label >= 0 ? vertex.count : 0);
  std::vector<double> values(vertex.properties.size());
  for (uint64_t i = 0; i < vertex.count; ++i) {
    for (size_t j = 0; j < values.size(); ++j) {
      const PlyProperty& property = vertex.properties[j];
      if (property.is_list) {
        numbers->Skip(property);
      } else {
        values[j] = numbers->Read(property.type);
      }
    }
    for (int k = 0; k < 3; ++k) {
      cloud.positions[i][k] = static_cast<float>(values[layout.position[k]]);
      if (layout.has_normals) {
        cloud.normals[i][k] = static_cast<float>(values[layout.normal[k]]);
      }
      if (layout.has_colors) {
        cloud.colors[i][k] = ToByte(values[layout.color[k]]);
      }
    }
    if (layout.confidence >= 0) {
      cloud.confidences[i] = ClampConfidence(values[layout.confidence]);
    }
    if (layout.label >= 0) {
      cloud.labels[i] = ToLabel(values[layout.label]);
    }
  }
  return cloud;
}

PlyCloud ReadPlyCloud(const std::filesystem::path& path) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the vertices");
  return ReadPlyVertices(SkipToVertices(header, path, &numbers, kMaxIndexed),
                         path, &numbers);
}

uint64_t CountPlyVertices(const std::filesystem::path& path) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the vertices");
  return SkipToVertices(header, path, &numbers).count;
}

void StreamCloud(const std::filesystem::path& path,
                 const std::filesystem::path& visibility_path,
                 size_t max_points,
                 const std::function<void(CloudPiece piece)>& visit) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the vertices");
  PlyElement rest = SkipToVertices(header, path, &numbers);
  VisibilityReader visibility(visibility_path, rest.count);
  while (rest.count > 0) {
    PlyElement piece = rest;
    piece.count = std::min<uint64_t>(rest.count, max_points);
    CloudPiece read;
    read.cloud = ReadPlyVertices(piece, path, &numbers);
    visibility.Read(piece.count, &read.visibility);
    rest.count -= piece.count;
    visit(std::move(read));
  }
  visibility.ExpectEnd();
}

}  // namespace colmap_ext
