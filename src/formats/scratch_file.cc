#include "formats/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

[[noreturn]] void Throw(const std::filesystem::path& folder, const char* what) {
  throw FileError(folder, std::string(what) + std::strerror(errno));
}

}  // namespace

// A name is there for a moment only.
ScratchFile::ScratchFile(const std::filesystem::path& folder)
    : folder_(folder) {
  std::string path = (folder / ".colmap_ext.XXXXXX").string();
  descriptor_ = mkostemp(path.data(), O_CLOEXEC);
  if (descriptor_ < 0) {
    Throw(folder_, "there can be no temporary file: ");
  }
  unlink(path.c_str());
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
