#include "colmap_ext/read_ply_cloud.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string>

#include "colmap_ext/byte_reader.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/ply_header.h"

namespace colmap_ext {

namespace {

constexpr const char* kWhat = "the vertices";

// The numbers of a PLY body, one after the other.
class NumberReader {
 public:
  NumberReader(ByteReader* reader, PlyFormat format)
      : reader_(reader), format_(format) {}

  double Read(PlyType type) {
    return format_ == PlyFormat::kAscii ? ReadAscii() : ReadBinary(type);
  }

  void Skip(const PlyProperty& property) {
    if (!property.is_list) {
      Read(property.type);
      return;
    }
    const double count = Read(property.count_type);
    if (!(count >= 0 && count <= static_cast<double>(reader_->Remaining()))) {
      throw FileError(reader_->Path(),
                      "truncated or damaged: a list of impossible length");
    }
    for (uint64_t i = 0; i < static_cast<uint64_t>(count); ++i) {
      Read(property.type);
    }
  }

 private:
  template <typename T>
  static double As(const std::array<char, 8>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return static_cast<double>(value);
  }

  double ReadBinary(PlyType type) {
    std::array<char, 8> bytes;
    const size_t size = PlyTypeSize(type);
    reader_->Read(bytes.data(), size, kWhat);
    if (format_ == PlyFormat::kBinaryBigEndian) {
      std::reverse(bytes.begin(), bytes.begin() + size);
    }
    switch (type) {
      case PlyType::kInt8:
        return As<int8_t>(bytes);
      case PlyType::kUint8:
        return As<uint8_t>(bytes);
      case PlyType::kInt16:
        return As<int16_t>(bytes);
      case PlyType::kUint16:
        return As<uint16_t>(bytes);
      case PlyType::kInt32:
        return As<int32_t>(bytes);
      case PlyType::kUint32:
        return As<uint32_t>(bytes);
      case PlyType::kFloat32:
        return As<float>(bytes);
      case PlyType::kFloat64:
        return As<double>(bytes);
    }
    return 0;
  }

  double ReadAscii() {
    const auto is_space = [](char c) {
      return c == ' ' || c == '\n' || c == '\r' || c == '\t';
    };
    char c = reader_->Read<char>(kWhat);
    while (is_space(c)) {
      c = reader_->Read<char>(kWhat);
    }
    std::array<char, 64> item;
    size_t length = 0;
    while (!is_space(c) && length < item.size()) {
      item[length++] = c;
      if (reader_->Remaining() == 0) {
        break;
      }
      c = reader_->Read<char>(kWhat);
    }
    return ParseNumber(item.data(), length);
  }

  double ParseNumber(const char* item, size_t length) {
    const char* begin = item[0] == '+' ? item + 1 : item;
    double number = 0;
    const auto [end, error] = std::from_chars(begin, item + length, number);
    if (error == std::errc::result_out_of_range) {
      return std::numeric_limits<double>::infinity();
    }
    if (error != std::errc() || end != item + length) {
      throw FileError(
          reader_->Path(),
          "damaged: '" + std::string(item, length) + "' is not a number");
    }
    return number;
  }

  ByteReader* reader_;
  PlyFormat format_;
};

void SkipElement(const PlyElement& element, NumberReader* numbers) {
  if (element.properties.empty()) {
    return;
  }
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      numbers->Skip(property);
    }
  }
}

// Where in a vertex, as an index of its properties, are its coordinates?
struct VertexLayout {
  std::array<int, 3> position;
  std::array<int, 3> normal;
  std::array<int, 3> color;
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
    throw FileError(path, "not a point cloud: its vertices have no x, y, z");
  }
  layout.has_normals = find({"nx", "ny", "nz"}, &layout.normal);
  layout.has_colors =
      find({"red", "green", "blue"}, &layout.color) ||
      find({"diffuse_red", "diffuse_green", "diffuse_blue"}, &layout.color);
  for (int i = 0; layout.has_colors && i < 3; ++i) {
    layout.has_colors =
        vertex.properties[layout.color[i]].type == PlyType::kUint8;
  }
  return layout;
}

PlyCloud ReadVertices(const PlyElement& vertex, const VertexLayout& layout,
                      NumberReader* numbers) {
  PlyCloud cloud;
  cloud.positions.resize(vertex.count);
  cloud.normals.resize(layout.has_normals ? vertex.count : 0);
  cloud.colors.resize(layout.has_colors ? vertex.count : 0);
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
        cloud.colors[i][k] = static_cast<uint8_t>(
            std::clamp(values[layout.color[k]], 0.0, 255.0));
      }
    }
  }
  return cloud;
}

}  // namespace

PlyCloud ReadPlyCloud(const std::filesystem::path& path) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  NumberReader numbers(&reader, header.format);
  for (const PlyElement& element : header.elements) {
    const uint64_t min_bytes = element.MinBytes(header.format);
    // The end of the file may stand for the last white space.
    if (min_bytes > 0 && element.count > (reader.Remaining() + 1) / min_bytes) {
      throw FileError(path, "truncated or damaged: it promises " +
                                std::to_string(element.count) + " " +
                                element.name + " elements, but has room for " +
                                std::to_string(reader.Remaining() / min_bytes));
    }
    if (element.name == "vertex") {
      return ReadVertices(element, FindLayout(element, path), &numbers);
    }
    SkipElement(element, &numbers);
  }
  throw FileError(path, "not a point cloud: it has no vertices");
}

}  // namespace colmap_ext
