#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "formats/errors.h"

namespace colmap_ext {

static_assert(std::endian::native == std::endian::little,
              "COLMAP's files are little-endian, and are read as they are");

// Reads a file sequentially and keeps track of the number of remaining bytes,
// so that no count in the file has to be trusted.
class ByteReader {
 public:
  // \throw FileError if there is no such regular file, or it is not readable.
  explicit ByteReader(const std::filesystem::path& path);

  const std::filesystem::path& Path() const { return path_; }

  // Bytes that have not been read yet.
  uint64_t Remaining() const { return size_ - position_; }

  // \param what  is being read, for the message: "point 12".
  // \throw FileError if the file ends before.
  void Read(void* bytes, size_t num_bytes, const char* what) {
    if (num_bytes == 0) {  // the address of nothing may be null
      return;
    }
    if (num_bytes <= buffer_end_ - buffer_begin_) {
      Take(static_cast<char*>(bytes), num_bytes);
    } else {
      ReadAcrossBuffers(static_cast<char*>(bytes), num_bytes, what);
    }
  }

  template <typename T>
  T Read(const char* what) {
    T value;
    Read(&value, sizeof(T), what);
    return value;
  }

  // \throw FileError if the file ends before.
  void Skip(uint64_t num_bytes, const char* what);

  // A count of things to come, each of which takes at least so many bytes.
  // \throw FileError if the rest of the file cannot hold as many.
  uint64_t ReadCount(uint64_t min_bytes_each, const char* what);

  // \throw FileError if anything is left.
  void ExpectEnd() const;

  // \throw FileError about this file.
  [[noreturn]] void Throw(const std::string& message) const {
    throw FileError(path_, message);
  }

 private:
  void Take(char* bytes, size_t num_bytes);
  void ReadAcrossBuffers(char* bytes, size_t num_bytes, const char* what);
  void FillBuffer(const char* what);
  [[noreturn]] void ThrowTruncated(const char* what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  uint64_t size_ = 0;      // of the file, bytes
  uint64_t position_ = 0;  // of the next byte to be handed out
  std::vector<char> buffer_;
  size_t buffer_begin_ = 0;  // of what has not been handed out
  size_t buffer_end_ = 0;
};

// \throw FileError unless the path is that of a regular file.
void ExpectRegularFile(const std::filesystem::path& path);

}  // namespace colmap_ext
