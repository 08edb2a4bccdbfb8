#include "tests/fuzz/memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

namespace colmap_ext {

MemoryFile::MemoryFile() : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error("no file in memory");
  }
  path_ = "/proc/" + std::to_string(getpid()) + "/fd/" +
          std::to_string(descriptor_);
}

MemoryFile::~MemoryFile() { close(descriptor_); }

void MemoryFile::Set(const void* bytes, size_t num_bytes) {
  if (ftruncate(descriptor_, 0) != 0 ||
      pwrite(descriptor_, bytes, num_bytes, 0) !=
          static_cast<ssize_t>(num_bytes)) {
    throw std::runtime_error("the file in memory can not be written");
  }
}

}  // namespace colmap_ext
