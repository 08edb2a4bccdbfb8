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

// Reads the numbers of a PLY file's body, one after the other.
class PlyNumberReader {
 public:
  // \param what  is being read, for the messages: "the vertices".
  PlyNumberReader(ByteReader* reader, PlyFormat format, const char* what)
      : reader_(reader), format_(format), what_(what) {}

  // \throw FileError if the file ends before, or has no number there.
  double Read(PlyType type) {
    return format_ == PlyFormat::kAscii ? ReadAscii() : ReadBinary(type);
  }

  // \throw FileError if a list's length is impossible, or as Read().
  void Skip(const PlyProperty& property);
  void Skip(const PlyElement& element);

  // The length of a list.
  // \throw FileError if the rest of the file can not hold as many.
  uint64_t ReadLength(const PlyProperty& list);

  // \throw FileError if there are more of the element than max_count, or the
  //        rest of the file can not hold them.
  void ExpectRoomFor(const PlyElement& element,
                     uint64_t max_count = UINT64_MAX) const;

 private:
  double ReadBinary(PlyType type);
  double ReadAscii();
  double ParseNumber(const char* item, size_t length) const;

  ByteReader* reader_;
  PlyFormat format_;
  const char* what_;
};

}  // namespace colmap_ext
