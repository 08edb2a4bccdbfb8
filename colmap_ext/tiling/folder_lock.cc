#include "colmap_ext/tiling/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "formats/errors.h"

namespace colmap_ext {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(open((folder / "plan.lock").c_str(),
                       O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) {
    throw FileError(folder, "can not be written");
  }
  is_locked_ = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  if (!is_locked_ && errno == EWOULDBLOCK) {
    close(descriptor_);
    throw FileError(folder, "another planner is at work there");
  }
}

FolderLock::~FolderLock() { close(descriptor_); }

}  // namespace colmap_ext
