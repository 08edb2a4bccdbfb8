// G. Turk's PLY format: http://paulbourke.net/dataformats/ply

#include "formats/ply_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kMaxLineLength = 1 << 16;

std::string ReadLine(ByteReader* reader) {
  std::string line;
  for (char c = reader->Read<char>("the header"); c != '\n';
       c = reader->Read<char>("the header")) {
    line.push_back(c);
    if (line.size() > kMaxLineLength) {
      throw FileError(reader->Path(), "not a PLY file: endless header line");
    }
  }
  if (line.ends_with('\r')) {
    line.pop_back();
  }
  return line;
}

class HeaderParser {
 public:
  explicit HeaderParser(ByteReader* reader) : reader_(reader) {}

  PlyHeader Parse() {
    if (reader_->Remaining() < 4 || ReadLine(reader_) != "ply") {
      Throw("not a PLY file");
    }
    bool has_format = false;
    for (std::string line = ReadLine(reader_); line != "end_header";
         line = ReadLine(reader_)) {
      std::istringstream items(line);
      std::string keyword;
      items >> keyword;
      if (keyword == "format") {
        ParseFormat(items);
        has_format = true;
      } else if (keyword == "element") {
        ParseElement(items);
      } else if (keyword == "property") {
        ParseProperty(items);
      } else if (keyword == "comment") {
        std::getline(items >> std::ws, header_.comments.emplace_back());
      } else if (keyword != "obj_info" && !keyword.empty()) {
        Throw("PLY header: unknown line '" + line + "'");
      }
    }
    if (!has_format) {
      Throw("PLY header: no format");
    }
    return std::move(header_);
  }

 private:
  void ParseFormat(std::istringstream& items) {
    static const std::map<std::string, PlyFormat> kFormats = {
        {"ascii", PlyFormat::kAscii},
        {"binary_little_endian", PlyFormat::kBinaryLittleEndian},
        {"binary_big_endian", PlyFormat::kBinaryBigEndian}};
    std::string name;
    items >> name;
    const auto format = kFormats.find(name);
    if (format == kFormats.end()) {
      Throw("PLY header: unknown format '" + name + "'");
    }
    header_.format = format->second;
  }

  void ParseElement(std::istringstream& items) {
    PlyElement element;
    std::string count;
    items >> element.name >> count;
    const auto [end, error] = std::from_chars(
        count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size()) {
      Throw("PLY header: '" + count + "' is not a count of " + element.name);
    }
    header_.elements.push_back(std::move(element));
  }

  void ParseProperty(std::istringstream& items) {
    if (header_.elements.empty()) {
      Throw("PLY header: a property before any element");
    }
    PlyProperty property;
    std::string type;
    items >> type;
    if (type == "list") {
      property.is_list = true;
      items >> type;
      property.count_type = ParseType(type);
      if (property.count_type == PlyType::kFloat32 ||
          property.count_type == PlyType::kFloat64) {
        Throw("PLY header: a list counted by " + type);
      }
      items >> type;
    }
    property.type = ParseType(type);
    items >> property.name;
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType ParseType(const std::string& name) {
    static const std::map<std::string, PlyType> kTypes = {
        {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},
        {"uchar", PlyType::kUint8},    {"uint8", PlyType::kUint8},
        {"short", PlyType::kInt16},    {"int16", PlyType::kInt16},
        {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},
        {"int", PlyType::kInt32},      {"int32", PlyType::kInt32},
        {"uint", PlyType::kUint32},    {"uint32", PlyType::kUint32},
        {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32},
        {"double", PlyType::kFloat64}, {"float64", PlyType::kFloat64}};
    const auto type = kTypes.find(name);
    if (type == kTypes.end()) {
      Throw("PLY header: unknown type '" + name + "'");
    }
    return type->second;
  }

  [[noreturn]] void Throw(const std::string& message) const {
    throw FileError(reader_->Path(), message);
  }

  ByteReader* reader_;
  PlyHeader header_;
};

template <typename T>
double As(const std::array<char, 8>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return static_cast<double>(value);
}

}  // namespace

size_t PlyTypeSize(PlyType type) {
  constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<int>(type)];
}

uint64_t PlyElement::MinBytes(PlyFormat format) const {
  uint64_t num_bytes = 0;
  for (const PlyProperty& property : properties) {
    if (format == PlyFormat::kAscii) {
      num_bytes += 2;  // a digit and what ends it
    } else {
      num_bytes +=
          PlyTypeSize(property.is_list ? property.count_type : property.type);
    }
  }
  return num_bytes;
}

int PlyElement::Find(const std::string& property_name) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property_name && !properties[i].is_list) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

PlyHeader ReadPlyHeader(ByteReader* reader) {
  return HeaderParser(reader).Parse();
}

void PlyNumberReader::Skip(const PlyProperty& property) {
  if (!property.is_list) {
    Read(property.type);
    return;
  }
  const uint64_t length = ReadLength(property);
  for (uint64_t i = 0; i < length; ++i) {
    Read(property.type);
  }
}

void PlyNumberReader::Skip(const PlyElement& element) {
  if (element.properties.empty()) {
    return;
  }
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      Skip(property);
    }
  }
}

uint64_t PlyNumberReader::ReadLength(const PlyProperty& list) {
  const double length = Read(list.count_type);
  if (!(length >= 0 && length <= static_cast<double>(reader_->Remaining()))) {
    throw FileError(reader_->Path(),
                    "truncated or damaged: a list of impossible length");
  }
  return static_cast<uint64_t>(length);
}

void PlyNumberReader::ExpectRoomFor(const PlyElement& element,
                                    uint64_t max_count) const {
  const uint64_t min_bytes = element.MinBytes(format_);
  // The end of the file may stand for the last white space.
  if (min_bytes > 0 && element.count > (reader_->Remaining() + 1) / min_bytes) {
    throw FileError(
        reader_->Path(),
        fmt::format("truncated or damaged: it promises {} {} elements, but has "
                    "room for {}",
                    element.count, element.name,
                    reader_->Remaining() / min_bytes));
  }
  if (element.count > max_count) {
    throw FileError(reader_->Path(),
                    fmt::format("too large: it has {} {} elements, but at most "
                                "{} can be numbered",
                                element.count, element.name, max_count));
  }
}

double PlyNumberReader::ReadBinary(PlyType type) {
  std::array<char, 8> bytes;
  const size_t size = PlyTypeSize(type);
  reader_->Read(bytes.data(), size, what_);
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

double PlyNumberReader::ReadAscii() {
  const auto is_space = [](char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
  };
  char c = reader_->Read<char>(what_);
  while (is_space(c)) {
    c = reader_->Read<char>(what_);
  }
  std::array<char, 64> item;
  size_t length = 0;
  while (!is_space(c) && length < item.size()) {
    item[length++] = c;
    if (reader_->Remaining() == 0) {
      break;
    }
    c = reader_->Read<char>(what_);
  }
  return ParseNumber(item.data(), length);
}

double PlyNumberReader::ParseNumber(const char* item, size_t length) const {
  const char* begin = item[0] == '+' ? item + 1 : item;
  double number = 0;
  const auto [end, error] = std::from_chars(begin, item + length, number);
  if (error == std::errc::result_out_of_range) {
    return std::numeric_limits<double>::infinity();
  }
  if (error != std::errc() || end != item + length) {
    throw FileError(reader_->Path(), "damaged: '" + std::string(item, length) +
                                         "' is not a number");
  }
  return number;
}

}  // namespace colmap_ext
