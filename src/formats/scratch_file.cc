#include "formats/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

[[noreturn]] void Throw(const std::filesystem::path& folder, const char* what) {
  throw FileError(folder, std::string(what) + std::strerror(errno));
}

// For file systems without O_TMPFILE. The name is there for a moment only, in
// which no signal ends the program.
// \return the descriptor; negative, with errno, if there can be no file
int OpenAndUnlink(const std::filesystem::path& folder) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  std::string path = (folder / ".colmap_ext.XXXXXX").string();
  const int descriptor = mkostemp(path.data(), O_CLOEXEC);
  const int error = errno;
  if (descriptor >= 0) {
    unlink(path.c_str());
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return descriptor;
}

}  // namespace

ScratchFile::ScratchFile(const std::filesystem::path& folder)
    : folder_(folder),
      descriptor_(open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)) {
  if (descriptor_ < 0) {
    descriptor_ = OpenAndUnlink(folder);
  }
  if (descriptor_ < 0) {
    Throw(folder_, "there can be no temporary file: ");
  }
}

ScratchFile::~ScratchFile() { close(descriptor_); }

void ScratchFile::Append(const void* bytes, size_t num_bytes) {
  Overwrite(size_, bytes, num_bytes);
  size_ += num_bytes;
}

void ScratchFile::Read(uint64_t offset, size_t num_bytes, void* bytes) const {
  size_t num_read = 0;
  while (num_read < num_bytes) {
    const ssize_t count =
        pread(descriptor_, static_cast<char*>(bytes) + num_read,
              num_bytes - num_read, static_cast<off_t>(offset + num_read));
    if (count == 0 || (count < 0 && errno != EINTR)) {
      Throw(folder_, "a temporary file can not be read: ");
    }
    num_read += count > 0 ? static_cast<size_t>(count) : 0;
  }
}

void ScratchFile::Overwrite(uint64_t offset, const void* bytes,
                            size_t num_bytes) {
  size_t num_written = 0;
  while (num_written < num_bytes) {
    const ssize_t count = pwrite(
        descriptor_, static_cast<const char*>(bytes) + num_written,
        num_bytes - num_written, static_cast<off_t>(offset + num_written));
    if (count < 0 && errno != EINTR) {
      Throw(folder_, "a temporary file can not be written: ");
    }
    num_written += count > 0 ? static_cast<size_t>(count) : 0;
  }
}

}  // namespace colmap_ext
