#pragma once

#include <filesystem>

namespace colmap_ext {

// While it exists, no other process can plan a meshing or a refinement in the
// folder. Has no effect on network file systems without locks.
class FolderLock {
 public:
  // \throw FileError if another has it, or the folder can not be written
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  // Whether the lock is held; false on a file system without locks.
  bool IsLocked() const { return is_locked_; }

 private:
  int descriptor_;
  bool is_locked_ = false;
};

// The warning if the file system has no locks.
inline constexpr char kNoLocks[] =
    "the plan's file system has no locks (flock): do not run two planners in "
    "its folder at once";

}  // namespace colmap_ext
