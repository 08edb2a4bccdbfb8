#pragma once

#include <filesystem>

namespace colmap_ext {

// Keeps others from planning in a folder, meshes or their refinement, as long
// as it lives. Some network file systems have no locks: there it keeps nobody.
class FolderLock {
 public:
  // \throw FileError if another has it, or the folder can not be written
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  // Whether it keeps others from planning.
  bool IsLocked() const { return is_locked_; }

 private:
  int descriptor_;
  bool is_locked_ = false;
};

// The warning where a lock is none.
inline constexpr char kNoLocks[] =
    "the plan's file system has no locks (flock): do not run two planners in "
    "its folder at once";

}  // namespace colmap_ext
