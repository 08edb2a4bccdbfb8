#include "colmap_ext/jobs/job_file.h"

#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

#include "tests/formats/test_files.h"

namespace {

int flock_error = 0;  // of all calls; 0: none

}  // namespace

// Instead of the system's.
extern "C" int flock(int descriptor, int operation) noexcept {
  if (flock_error != 0) {
    errno = flock_error;
    return -1;
  }
  return static_cast<int>(syscall(SYS_flock, descriptor, operation));
}

namespace colmap_ext {
namespace {

TEST(FolderLock, KeepsOthersFromPlanning) {
  const TemporaryFolder folder;
  {
    const FolderLock lock(folder.Path());
    EXPECT_TRUE(lock.IsLocked());
    ExpectFileError("another planner is at work",
                    [&] { FolderLock{folder.Path()}; });
  }
  EXPECT_TRUE(FolderLock(folder.Path()).IsLocked());
}

TEST(FolderLock, IsNoneWhereTheFileSystemHasNone) {
  const TemporaryFolder folder;
  for (const int error : {ENOLCK, ENOSYS, EOPNOTSUPP, EINVAL}) {
    flock_error = error;
    EXPECT_FALSE(FolderLock(folder.Path()).IsLocked()) << error;
  }
  flock_error = 0;
  ExpectFileError("written", [&] { FolderLock{folder.Path() / "none"}; });
}

}  // namespace
}  // namespace colmap_ext
