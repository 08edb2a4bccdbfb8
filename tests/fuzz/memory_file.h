#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace colmap_ext {

// A file in memory that is read by a path as any other file.
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  // Replaces what is in the file.
  void Set(const void* bytes, size_t num_bytes);

  const std::filesystem::path& Path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

}  // namespace colmap_ext
