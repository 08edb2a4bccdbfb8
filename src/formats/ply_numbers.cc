#include "formats/ply_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "formats/errors.h"

namespace colmap_ext {

namespace {

template <typename T>
double As(const std::array<char, 8>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return static_cast<double>(value);
}

}  // namespace

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
