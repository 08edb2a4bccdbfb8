#include "colmap_ext/tiling/section_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/mix_bits.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kKindLength = 8;

// After the checksums.
struct Tail {
  uint64_t checksum;   // of them
  uint64_t num_bytes;  // that they are of
};

// Tells bytes apart that were changed by accident, not by an attacker.
uint64_t Checksum(const char* bytes, size_t num_bytes) {
  // Four sums, as the processor can do as many at a time.
  std::array<uint64_t, 4> sums = {1, 2, 3, 4};
  for (size_t i = 0; i < num_bytes; i += sizeof(sums)) {
    std::array<uint64_t, 4> words = {};
    std::memcpy(words.data(), bytes + i, std::min(sizeof(sums), num_bytes - i));
    for (size_t k = 0; k < 4; ++k) {
      sums[k] = (sums[k] ^ words[k]) * kSplitMixStep;
      sums[k] ^= sums[k] >> 32;
    }
  }
  uint64_t checksum = num_bytes;
  for (const uint64_t sum : sums) {
    checksum = MixBits(checksum + sum);
  }
  return checksum;
}

uint64_t Checksum(const std::vector<uint64_t>& words) {
  return Checksum(reinterpret_cast<const char*>(words.data()),
                  words.size() * sizeof(uint64_t));
}

}  // namespace

SectionWriter::SectionWriter(const std::filesystem::path& path,
                             const std::string& kind, uint64_t identity,
                             uint64_t num_sections)
    : file_(files_.Add(path)) {
  Write(kind.data(), kKindLength);
  Write(&identity, sizeof(identity));
  Write(&num_sections, sizeof(num_sections));
}

void SectionWriter::Write(const void* bytes, size_t num_bytes) {
  const char* from = static_cast<const char*>(bytes);
  file_->Write(from, num_bytes);
  num_bytes_ += num_bytes;
  while (num_bytes > 0) {
    const size_t count = std::min(num_bytes, kSectionChunk - chunk_.size());
    chunk_.insert(chunk_.end(), from, from + count);
    from += count;
    num_bytes -= count;
    if (chunk_.size() == kSectionChunk) {
      EndChunk();
    }
  }
}

void SectionWriter::EndChunk() {
  checksums_.push_back(Checksum(chunk_.data(), chunk_.size()));
  chunk_.clear();
}

void SectionWriter::Commit() {
  if (!chunk_.empty()) {
    EndChunk();
  }
  file_->Write(checksums_.data(), checksums_.size() * sizeof(uint64_t));
  file_->Write(Tail{Checksum(checksums_), num_bytes_});
  files_.Commit();
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
    ThrowDamaged();
  }
  ReadUnchecked(0, sizeof(head), &head);
  if (kind.compare(0, kKindLength, head.kind, kKindLength) != 0 ||
      head.num_sections != num_sections) {
    throw FileError(path, "not of this version: plan again by mesh_planner");
  }
  if (head.identity != identity) {
    throw FileError(path, "belongs to another plan: run its tile again");
  }
  ReadChecksums(size);
  ReadBytes(0, sizeof(head), &head);
  uint64_t offset = sizeof(head);
  for (uint64_t i = 0; i < num_sections; ++i) {
    uint64_t bytes = 0;
    if (num_bytes_ - offset < sizeof(bytes)) {
      ThrowDamaged();
    }
    ReadBytes(offset, sizeof(bytes), &bytes);
    offset += sizeof(bytes);
    if (bytes > num_bytes_ - offset) {
      ThrowDamaged();
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

void SectionReader::ReadChecksums(uint64_t size) {
  Tail tail = {};
  if (size < sizeof(tail)) {
    ThrowDamaged();
  }
  ReadUnchecked(size - sizeof(tail), sizeof(tail), &tail);
  num_bytes_ = tail.num_bytes;
  const uint64_t num_chunks =
      num_bytes_ / kSectionChunk + (num_bytes_ % kSectionChunk != 0 ? 1 : 0);
  if (num_bytes_ > size ||
      size - num_bytes_ != num_chunks * sizeof(uint64_t) + sizeof(tail)) {
    ThrowDamaged();
  }
  checksums_.resize(num_chunks);
  ReadUnchecked(num_bytes_, num_chunks * sizeof(uint64_t), checksums_.data());
  if (Checksum(checksums_) != tail.checksum) {
    ThrowDamaged();
  }
}

// Whole chunks go where they belong at once; of those at both ends a part does.
void SectionReader::ReadBytes(uint64_t offset, size_t num_bytes,
                              void* bytes) const {
  char* to = static_cast<char*>(bytes);
  std::array<char, kSectionChunk> buffer;
  while (num_bytes > 0) {
    const uint64_t chunk = offset / kSectionChunk;
    const uint64_t begin = chunk * kSectionChunk;
    const size_t chunk_size =
        std::min<uint64_t>(kSectionChunk, num_bytes_ - begin);
    const size_t skip = offset - begin;
    size_t count = std::min(num_bytes, chunk_size - skip);
    if (count < kSectionChunk) {
      ReadUnchecked(begin, chunk_size, buffer.data());
      CheckChunk(chunk, buffer.data(), chunk_size);
      std::memcpy(to, buffer.data() + skip, count);
    } else {
      count = num_bytes / kSectionChunk * kSectionChunk;
      ReadUnchecked(offset, count, to);
      for (size_t i = 0; i < count / kSectionChunk; ++i) {
        CheckChunk(chunk + i, to + i * kSectionChunk, kSectionChunk);
      }
    }
    offset += count;
    to += count;
    num_bytes -= count;
  }
}

void SectionReader::CheckChunk(uint64_t chunk, const char* bytes,
                               size_t num_bytes) const {
  if (Checksum(bytes, num_bytes) != checksums_[chunk]) {
    ThrowDamaged();
  }
}

void SectionReader::ThrowDamaged() const {
  throw FileError(path_,
                  "truncated or damaged: remove it, and run what makes it "
                  "again");
}

void SectionReader::ReadUnchecked(uint64_t offset, size_t num_bytes,
                                  void* bytes) const {
  size_t num_read = 0;
  while (num_read < num_bytes) {
    const ssize_t count =
        pread(descriptor_.value, static_cast<char*>(bytes) + num_read,
              num_bytes - num_read, static_cast<off_t>(offset + num_read));
    if (count == 0 || (count < 0 && errno != EINTR)) {
      if (count == 0) {
        ThrowDamaged();
      }
      throw FileError(path_,
                      std::string("can not be read: ") + std::strerror(errno));
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
