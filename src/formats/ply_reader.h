#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <iosfwd>
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

  // \param types  of the property; none for any.
  // \return -1 if there is no such scalar property.
  int Find(const std::string& property_name,
           std::initializer_list<PlyType> types = {}) const;
};

// Reads a PLY file: its header, then the numbers of its body, one after the
// other.
class PlyReader {
 public:
  // \param what  is being read, for the messages: "the vertices".
  // \throw FileError if the file is missing, or has no PLY header.
  PlyReader(const std::filesystem::path& path, const char* what);

  // In the order of the file.
  const std::vector<PlyElement>& Elements() const { return elements_; }

  // What follows the word `comment` in each of these lines.
  const std::vector<std::string>& Comments() const { return comments_; }

  // \throw FileError if the file ends before, or has no number there.
  double Read(PlyType type) {
    return format_ == PlyFormat::kAscii ? ReadAscii() : ReadBinary(type);
  }

  // \throw FileError if a list's length is impossible, or as Read().
  void Skip(const PlyProperty& property);
  void Skip(const PlyElement& element);

  // The length of a list.
  // \throw FileError if the rest of the file cannot hold as many.
  uint64_t ReadLength(const PlyProperty& list);

  // \throw FileError if there are more of the element than max_count, or the
  //        rest of the file cannot hold them.
  void ExpectRoomFor(const PlyElement& element,
                     uint64_t max_count = UINT64_MAX) const;

  // \throw FileError
  [[noreturn]] void Throw(const std::string& message) const {
    file_.Throw(message);
  }

 private:
  std::string ReadLine();
  void ParseFormat(const std::string& name);
  PlyElement ParseElement(std::istream& items) const;
  PlyProperty ParseProperty(std::istream& items) const;
  PlyType ParseType(const std::string& name) const;
  uint64_t MinBytes(const PlyElement& element) const;
  double ReadBinary(PlyType type);
  double ReadAscii();

  ByteReader file_;
  const char* what_;
  PlyFormat format_ = PlyFormat::kAscii;
  std::vector<PlyElement> elements_;
  std::vector<std::string> comments_;
};

}  // namespace colmap_ext
