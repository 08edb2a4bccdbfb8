#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/errors.h"
#include "tests/fuzz/memory_file.h"

namespace colmap_ext {

// Reads the bytes as a file. The reader may refuse the file by a FileError;
// whatever else happens is a fault.
// \param read  takes the file's path.
template <typename Read>
int FuzzFile(const uint8_t* bytes, size_t num_bytes, Read read) {
  static MemoryFile file;
  file.Set(bytes, num_bytes);
  try {
    read(file.Path());
  } catch (const FileError&) {
  }
  return 0;
}

}  // namespace colmap_ext
