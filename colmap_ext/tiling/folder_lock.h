#pragma once

#include <filesystem>

namespace colmap_ext {

// Keeps others from planning in a folder, meshes or their refinement, as long
// as it lives.
class FolderLock {
 public:
  // \throw FileError if another has it, or the folder can not be written
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace colmap_ext
