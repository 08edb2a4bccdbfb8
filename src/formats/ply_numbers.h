#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/byte_reader.h"
#include "formats/ply_header.h"

namespace colmap_ext {

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
