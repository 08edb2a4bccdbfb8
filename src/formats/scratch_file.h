#pragma once

#include <cstdint>
#include <filesystem>

#include "base/byte_store.h"

namespace colmap_ext {

// Bytes in a file without a name, which is gone with the object, or with the
// program, whatever ends it.
class ScratchFile : public ByteStore {
 public:
  // \param folder  where there is room for it
  // \throw FileError if there can be none
  explicit ScratchFile(const std::filesystem::path& folder);
  ~ScratchFile() override;
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  // All of these throw a FileError if the disk is full, or fails.
  void Append(const void* bytes, size_t num_bytes) override;
  void Read(uint64_t offset, size_t num_bytes, void* bytes) const override;
  void Overwrite(uint64_t offset, const void* bytes, size_t num_bytes) override;

 private:
  std::filesystem::path folder_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace colmap_ext
