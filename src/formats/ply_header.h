#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/byte_reader.h"

namespace colmap_ext {

enum class PlyFormat { kAscii, kBinaryLittleEndian, kBinaryBigEndian };

enum class PlyType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat32,
  kFloat64,
};

size_t PlyTypeSize(PlyType type);  // bytes

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;  // of a list: of its items
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // of a list
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // The least that one of them takes in a file.
  uint64_t MinBytes(PlyFormat format) const;

  // \return -1 if there is no such scalar property.
  int Find(const std::string& property_name) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;   // in the order of the file
  std::vector<std::string> comments;  // what follows the word
};

// \throw FileError if it is not a PLY header.
PlyHeader ReadPlyHeader(ByteReader* reader);

}  // namespace colmap_ext
