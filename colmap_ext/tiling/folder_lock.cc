#include "colmap_ext/tiling/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "formats/errors.h"

namespace colmap_ext {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(open((folder / "plan.lock").c_str(),
                       O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
    return;
  }
  const bool is_open = descriptor_ >= 0;
  if (is_open) {
    close(descriptor_);
  }
  throw FileError(folder, is_open ? "another planner is at work there"
                                  : "can not be written");
}

FolderLock::~FolderLock() { close(descriptor_); }

}  // namespace colmap_ext
