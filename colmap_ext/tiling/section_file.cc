#include "colmap_ext/tiling/section_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kKindLength = 8;

}  // namespace

SectionWriter::SectionWriter(const std::filesystem::path& path,
                             const std::string& kind, uint64_t identity,
                             uint64_t num_sections)
    : file_(path) {
  file_.Write(kind.data(), kKindLength);
  file_.Write(identity);
  file_.Write(num_sections);
}

void SectionWriter::Commit() {
  AtomicFile* const files[] = {&file_};
  colmap_ext::Commit(files);
}

SectionReader::SectionReader(const std::filesystem::path& path,
                             const std::string& kind, uint64_t identity,
                             uint64_t num_sections)
    : path_(path) {
  const uint64_t size = [&] {
    std::error_code error;
    const uint64_t bytes = std::filesystem::file_size(path, error);
    if (error) {
      throw FileError(path, "can not be read: " + error.message());
    }
    return bytes;
  }();
  descriptor_.value = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_.value < 0) {
    throw FileError(path,
                    std::string("can not be read: ") + std::strerror(errno));
  }
  struct Head {
    char kind[kKindLength];
    uint64_t identity;
    uint64_t num_sections;
  } head = {};
  if (size < sizeof(head)) {
    throw FileError(path, "truncated or damaged");
  }
  ReadBytes(0, sizeof(head), &head);
  if (kind.compare(0, kKindLength, head.kind, kKindLength) != 0 ||
      head.num_sections != num_sections) {
    throw FileError(path, "not of this version: plan again by mesh_planner");
  }
  if (head.identity != identity) {
    throw FileError(path, "belongs to another plan: run its tile again");
  }
  uint64_t offset = sizeof(head);
  for (uint64_t i = 0; i < num_sections; ++i) {
    uint64_t bytes = 0;
    if (size - offset < sizeof(bytes)) {
      throw FileError(path, "truncated or damaged");
    }
    ReadBytes(offset, sizeof(bytes), &bytes);
    offset += sizeof(bytes);
    if (bytes > size - offset) {
      throw FileError(path, "truncated or damaged");
    }
    offsets_.push_back(offset);
    sizes_.push_back(bytes);
    offset += bytes;
  }
}

SectionReader::Descriptor::~Descriptor() {
  if (value >= 0) {
    close(value);
  }
}

void SectionReader::ReadBytes(uint64_t offset, size_t num_bytes,
                              void* bytes) const {
  size_t num_read = 0;
  while (num_read < num_bytes) {
    const ssize_t count =
        pread(descriptor_.value, static_cast<char*>(bytes) + num_read,
              num_bytes - num_read, static_cast<off_t>(offset + num_read));
    if (count == 0 || (count < 0 && errno != EINTR)) {
      throw FileError(path_, count == 0 ? "truncated or damaged"
                                        : std::string("can not be read: ") +
                                              std::strerror(errno));
    }
    num_read += count > 0 ? static_cast<size_t>(count) : 0;
  }
}

bool HasSections(const std::filesystem::path& path, const std::string& kind,
                 uint64_t identity, uint64_t num_sections) {
  try {
    const SectionReader reader(path, kind, identity, num_sections);
    return true;
  } catch (const FileError&) {
    return false;
  }
}

}  // namespace colmap_ext
