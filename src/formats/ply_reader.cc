// G. Turk's PLY format: http://paulbourke.net/dataformats/ply

#include "formats/ply_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <sstream>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

constexpr size_t kMaxLineLength = 1 << 16;

template <typename T>
double NumberAt(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

// By PlyType.
constexpr struct {
  const char* name;
  const char* sized_name;
  size_t size;                          // bytes
  double (*number)(const char* bytes);  // little-endian
} kTypes[] = {{"char", "int8", 1, &NumberAt<int8_t>},
              {"uchar", "uint8", 1, &NumberAt<uint8_t>},
              {"short", "int16", 2, &NumberAt<int16_t>},
              {"ushort", "uint16", 2, &NumberAt<uint16_t>},
              {"int", "int32", 4, &NumberAt<int32_t>},
              {"uint", "uint32", 4, &NumberAt<uint32_t>},
              {"float", "float32", 4, &NumberAt<float>},
              {"double", "float64", 8, &NumberAt<double>}};

}  // namespace

int PlyElement::Find(const std::string& property_name,
                     std::initializer_list<PlyType> types) const {
  const auto found =
      std::ranges::find_if(properties, [&](const auto& property) {
        return property.name == property_name && !property.is_list &&
               (types.size() == 0 ||
                std::ranges::count(types, property.type) > 0);
      });
  return found != properties.end()
             ? static_cast<int>(found - properties.begin())
             : -1;
}

PlyReader::PlyReader(const std::filesystem::path& path, const char* what)
    : file_(path), what_(what) {
  if (file_.Remaining() < 4 || ReadLine() != "ply") {
    Throw("not a PLY file");
  }
  bool has_format = false;
  for (std::string line = ReadLine(); line != "end_header"; line = ReadLine()) {
    std::istringstream items(line);
    std::string keyword;
    items >> keyword;
    if (keyword == "format") {
      std::string name;
      items >> name;
      ParseFormat(name);
      has_format = true;
    } else if (keyword == "element") {
      elements_.push_back(ParseElement(items));
    } else if (keyword == "property") {
      if (elements_.empty()) {
        Throw("PLY header: a property before any element");
      }
      elements_.back().properties.push_back(ParseProperty(items));
    } else if (keyword == "comment") {
      std::getline(items >> std::ws, comments_.emplace_back());
    } else if (keyword != "obj_info" && !keyword.empty()) {
      Throw("PLY header: unknown line '" + line + "'");
    }
  }
  if (!has_format) {
    Throw("PLY header: no format");
  }
}

std::string PlyReader::ReadLine() {
  std::string line;
  for (char c = file_.Read<char>("the header"); c != '\n';
       c = file_.Read<char>("the header")) {
    line.push_back(c);
    if (line.size() > kMaxLineLength) {
      Throw("not a PLY file: endless header line");
    }
  }
  if (line.ends_with('\r')) {
    line.pop_back();
  }
  return line;
}

void PlyReader::ParseFormat(const std::string& name) {
  constexpr const char* kNames[] = {"ascii", "binary_little_endian",
                                    "binary_big_endian"};
  const auto found = std::ranges::find(kNames, name);
  if (found == std::end(kNames)) {
    Throw("PLY header: unknown format '" + name + "'");
  }
  format_ = static_cast<PlyFormat>(found - kNames);
}

PlyElement PlyReader::ParseElement(std::istream& items) const {
  PlyElement element;
  std::string count;
  items >> element.name >> count;
  const auto [end, error] =
      std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (error != std::errc() || end != count.data() + count.size()) {
    Throw("PLY header: '" + count + "' is not a count of " + element.name);
  }
  return element;
}

PlyProperty PlyReader::ParseProperty(std::istream& items) const {
  PlyProperty property;
  std::string type;
  items >> type;
  if (type == "list") {
    property.is_list = true;
    items >> type;
    property.count_type = ParseType(type);
    if (property.count_type >= PlyType::kFloat32) {
      Throw("PLY header: a list counted by " + type);
    }
    items >> type;
  }
  property.type = ParseType(type);
  items >> property.name;
  return property;
}

PlyType PlyReader::ParseType(const std::string& name) const {
  const auto found = std::ranges::find_if(kTypes, [&name](const auto& type) {
    return name == type.name || name == type.sized_name;
  });
  if (found == std::end(kTypes)) {
    Throw("PLY header: unknown type '" + name + "'");
  }
  return static_cast<PlyType>(found - kTypes);
}

void PlyReader::Skip(const PlyProperty& property) {
  const uint64_t count = property.is_list ? ReadLength(property) : 1;
  for (uint64_t i = 0; i < count; ++i) {
    Read(property.type);
  }
}

void PlyReader::Skip(const PlyElement& element) {
  for (uint64_t i = 0; !element.properties.empty() && i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      Skip(property);
    }
  }
}

uint64_t PlyReader::ReadLength(const PlyProperty& list) {
  const double length = Read(list.count_type);
  if (!(length >= 0 && length <= static_cast<double>(file_.Remaining()))) {
    Throw("truncated or damaged: a list of impossible length");
  }
  return static_cast<uint64_t>(length);
}

// The least that one of the element takes in the file.
uint64_t PlyReader::MinBytes(const PlyElement& element) const {
  uint64_t num_bytes = 0;
  for (const PlyProperty& property : element.properties) {
    const PlyType type = property.is_list ? property.count_type : property.type;
    num_bytes += format_ == PlyFormat::kAscii
                     ? 2  // a digit and what ends it
                     : kTypes[static_cast<int>(type)].size;
  }
  return num_bytes;
}

void PlyReader::ExpectRoomFor(const PlyElement& element,
                              uint64_t max_count) const {
  const uint64_t min_bytes = MinBytes(element);
  // The end of the file may stand for the last white space.
  if (min_bytes > 0 && element.count > (file_.Remaining() + 1) / min_bytes) {
    Throw(fmt::format(
        "truncated or damaged: it promises {} {} elements, but has "
        "room for {}",
        element.count, element.name, file_.Remaining() / min_bytes));
  }
  if (element.count > max_count) {
    Throw(
        fmt::format("too large: it has {} {} elements, but at most {} can be "
                    "numbered",
                    element.count, element.name, max_count));
  }
}

double PlyReader::ReadBinary(PlyType type) {
  const auto& info = kTypes[static_cast<int>(type)];
  std::array<char, 8> bytes;
  file_.Read(bytes.data(), info.size, what_);
  if (format_ == PlyFormat::kBinaryBigEndian) {
    std::reverse(bytes.begin(), bytes.begin() + info.size);
  }
  return info.number(bytes.data());
}

double PlyReader::ReadAscii() {
  const auto is_space = [](char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
  };
  char c = file_.Read<char>(what_);
  while (is_space(c)) {
    c = file_.Read<char>(what_);
  }
  std::array<char, 64> item;
  size_t length = 0;
  while (!is_space(c) && length < item.size()) {
    item[length++] = c;
    if (file_.Remaining() == 0) {
      break;
    }
    c = file_.Read<char>(what_);
  }
  const char* const begin = item.data() + (item[0] == '+' ? 1 : 0);
  const char* const end = item.data() + length;
  double number = 0;
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error == std::errc::result_out_of_range) {
    return std::numeric_limits<double>::infinity();
  }
  if (error != std::errc() || rest != end) {
    Throw("damaged: '" + std::string(item.data(), length) +
          "' is not a number");
  }
  return number;
}

}  // namespace colmap_ext
