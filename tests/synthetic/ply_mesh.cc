#include "tests/synthetic/ply_mesh.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace colmap_ext::synthetic {
namespace {

static_assert(std::endian::native == std::endian::little);

struct Property {
  std::string name;
  std::string type;
  std::string count_type;  // of a list, else empty
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
};

Header ReadHeader(std::istream& file) {
  Header header;
  std::string line;
  std::getline(file, line);
  if (line.rfind("ply", 0) != 0) {
    throw std::runtime_error("not a PLY file");
  }
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word, type;
    words >> word;
    if (word == "format") {
      words >> header.format;
    } else if (word == "element") {
      Element& element = header.elements.emplace_back();
      words >> element.name >> element.count;
    } else if (word == "property" && !header.elements.empty()) {
      Property property;
      words >> property.type;
      if (property.type == "list") {
        words >> property.count_type >> property.type;
      }
      words >> property.name;
      header.elements.back().properties.push_back(property);
    } else if (word == "end_header") {
      return header;
    }
  }
  throw std::runtime_error("the header has no end");
}

// Reads numbers of any type and format as doubles.
class NumberReader {
 public:
  NumberReader(std::istream& file, const std::string& format)
      : file_(file),
        is_text_(format == "ascii"),
        is_swapped_(format == "binary_big_endian") {}

  double Read(const std::string& type) {
    if (is_text_) {
      double value = 0;
      if (!(file_ >> value)) {
        throw std::runtime_error("the file ends early");
      }
      return value;
    }
    if (type == "float" || type == "float32") return Read<float>();
    if (type == "double" || type == "float64") return Read<double>();
    if (type == "char" || type == "int8") return Read<int8_t>();
    if (type == "uchar" || type == "uint8") return Read<uint8_t>();
    if (type == "short" || type == "int16") return Read<int16_t>();
    if (type == "ushort" || type == "uint16") return Read<uint16_t>();
    if (type == "int" || type == "int32") return Read<int32_t>();
    if (type == "uint" || type == "uint32") return Read<uint32_t>();
    throw std::runtime_error("unknown type " + type);
  }

 private:
  template <typename T>
  double Read() {
    char bytes[sizeof(T)];
    if (!file_.read(bytes, sizeof(T))) {
      throw std::runtime_error("the file ends early");
    }
    if (is_swapped_) {
      std::reverse(bytes, bytes + sizeof(T));
    }
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
  }

  std::istream& file_;
  const bool is_text_;
  const bool is_swapped_;
};

// \param labels  of the vertices so far; empty where they have none.
void AddVertex(const std::map<std::string, double>& values,
               std::vector<int32_t>* labels, PlyMesh* ply) {
  const auto get = [&](const char* name) {
    const auto it = values.find(name);
    return it == values.end() ? 0.0 : it->second;
  };
  ply->mesh.vertices.emplace_back(get("x"), get("y"), get("z"));
  if (values.contains("nx")) {
    ply->normals.emplace_back(get("nx"), get("ny"), get("nz"));
  }
  if (values.contains("label")) {
    labels->push_back(static_cast<int32_t>(get("label")));
  }
  if (values.contains("red")) {
    ply->colors.push_back({static_cast<uint8_t>(get("red")),
                           static_cast<uint8_t>(get("green")),
                           static_cast<uint8_t>(get("blue"))});
  }
}

// Cuts a polygon into a fan of triangles.
void AddPolygon(const std::vector<uint32_t>& corners, PlyMesh* ply) {
  for (const uint32_t corner : corners) {
    if (corner >= ply->mesh.vertices.size()) {
      throw std::runtime_error("a facet has a vertex that is not there");
    }
  }
  for (size_t i = 2; i < corners.size(); ++i) {
    ply->mesh.facets.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

void ReadElement(const Element& element, NumberReader* reader,
                 std::vector<int32_t>* labels, PlyMesh* ply) {
  std::map<std::string, double> values;
  std::vector<uint32_t> corners;
  for (uint64_t i = 0; i < element.count; ++i) {
    corners.clear();
    for (const Property& property : element.properties) {
      if (property.count_type.empty()) {
        values[property.name] = reader->Read(property.type);
        continue;
      }
      const auto count =
          static_cast<uint64_t>(reader->Read(property.count_type));
      for (uint64_t k = 0; k < count; ++k) {
        const double value = reader->Read(property.type);
        if (property.name.rfind("vertex_ind", 0) == 0) {
          corners.push_back(static_cast<uint32_t>(value));
        }
      }
    }
    if (element.name == "vertex") {
      AddVertex(values, labels, ply);
    } else if (element.name == "face") {
      AddPolygon(corners, ply);
      if (values.contains("label")) {
        ply->labels.resize(ply->mesh.facets.size(), values["label"]);
      } else if (!labels->empty() && !corners.empty()) {
        ply->labels.resize(ply->mesh.facets.size(), labels->at(corners[0]));
      }
    }
  }
}

}  // namespace

PlyMesh ReadPlyMesh(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path + ": cannot be opened");
  }
  try {
    const Header header = ReadHeader(file);
    NumberReader reader(file, header.format);
    PlyMesh ply;
    std::vector<int32_t> labels;
    for (const Element& element : header.elements) {
      ReadElement(element, &reader, &labels, &ply);
    }
    return ply;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

void WritePlyMesh(const std::string& path, const TriangleMesh& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(mesh.vertices.size()) +
                      "\nproperty float x\nproperty float y\n"
                      "property float z\nelement face " +
                      std::to_string(mesh.facets.size()) +
                      "\nproperty list uchar int vertex_index\nend_header\n";
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    bytes.append(reinterpret_cast<const char*>(vertex.data()), 12);
  }
  for (const Facet& facet : mesh.facets) {
    bytes.push_back(3);
    bytes.append(reinterpret_cast<const char*>(facet.data()), 12);
  }
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), bytes.size());
  file.close();
  if (!file) {
    throw std::runtime_error(path + ": cannot be written");
  }
}

}  // namespace colmap_ext::synthetic
