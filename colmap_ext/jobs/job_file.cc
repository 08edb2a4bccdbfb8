#include "colmap_ext/jobs/job_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "colmap_ext/jobs/job_inputs.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kKindLength = 8;

struct JobFileHead {
  char kind[kKindLength];
  uint64_t identity;
};

// After the checksums.
struct JobFileTail {
  uint64_t checksum;      // of the checksums and of the two counts
  uint64_t num_bytes;     // that the checksums cover
  uint64_t num_sections;  // whose sizes are the last of these bytes
};

// A file of a job does not stand for another one of it.
uint64_t FileIdentity(const JobFile& file) {
  return HashBytes(file.path.filename().native(), file.identity);
}

uint64_t TailChecksum(std::vector<uint64_t> words, uint64_t num_bytes,
                      uint64_t num_sections) {
  words.push_back(num_bytes);
  words.push_back(num_sections);
  return HashBytes({reinterpret_cast<const char*>(words.data()),
                    words.size() * sizeof(uint64_t)});
}

}  // namespace

JobFileWriter::JobFileWriter(const JobFile& file)
    : file_(files_.Add(file.path)) {
  const uint64_t identity = FileIdentity(file);
  Write(file.kind.name, kKindLength);
  Write(&identity, sizeof(identity));
}

void JobFileWriter::Write(const void* bytes, size_t num_bytes) {
  const char* from = static_cast<const char*>(bytes);
  file_->Write(from, num_bytes);
  num_bytes_ += num_bytes;
  while (num_bytes > 0) {
    const size_t count = std::min(num_bytes, kJobFileChunk - chunk_.size());
    chunk_.insert(chunk_.end(), from, from + count);
    from += count;
    num_bytes -= count;
    if (chunk_.size() == kJobFileChunk) {
      EndChunk();
    }
  }
}

void JobFileWriter::EndChunk() {
  checksums_.push_back(HashBytes({chunk_.data(), chunk_.size()}));
  chunk_.clear();
}

void JobFileWriter::Commit() {
  Write(sizes_.data(), sizes_.size() * sizeof(uint64_t));
  if (!chunk_.empty()) {
    EndChunk();
  }
  file_->Write(checksums_.data(), checksums_.size() * sizeof(uint64_t));
  file_->Write(JobFileTail{TailChecksum(checksums_, num_bytes_, sizes_.size()),
                           num_bytes_, sizes_.size()});
  files_.Commit();
}

JobFileReader::JobFileReader(JobFile file) : file_(std::move(file)) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file_.path, error);
  descriptor_.value = open(file_.path.c_str(), O_RDONLY | O_CLOEXEC);
  if (error || descriptor_.value < 0) {
    throw FileError(
        file_.path,
        "can not be read: " + (error ? error.message() : std::strerror(errno)));
  }
  JobFileHead head = {};
  if (size < sizeof(head) + sizeof(JobFileTail)) {
    ThrowDamaged();
  }
  ReadUnchecked(0, sizeof(head), &head);
  if (std::memcmp(file_.kind.name, head.kind, kKindLength) != 0) {
    Throw("of another version of the program");
  }
  if (head.identity != FileIdentity(file_)) {
    Throw("belongs to another plan, or has another name there");
  }
  const uint64_t num_sections = ReadChecksums(size);
  ReadBytes(0, sizeof(head), &head);
  if (num_sections > (num_bytes_ - sizeof(head)) / sizeof(uint64_t)) {
    ThrowDamaged();
  }
  const uint64_t end = num_bytes_ - num_sections * sizeof(uint64_t);
  std::vector<uint64_t> sizes(num_sections);
  ReadBytes(end, num_sections * sizeof(uint64_t), sizes.data());
  offsets_ = {sizeof(head)};
  for (const uint64_t bytes : sizes) {
    if (bytes > end - offsets_.back()) {
      ThrowDamaged();
    }
    offsets_.push_back(offsets_.back() + bytes);
  }
}

JobFileReader::Descriptor::~Descriptor() {
  if (value >= 0) {
    close(value);
  }
}

// \return the number of sections
uint64_t JobFileReader::ReadChecksums(uint64_t size) {
  JobFileTail tail = {};
  ReadUnchecked(size - sizeof(tail), sizeof(tail), &tail);
  num_bytes_ = tail.num_bytes;
  const uint64_t num_chunks =
      num_bytes_ / kJobFileChunk + (num_bytes_ % kJobFileChunk != 0 ? 1 : 0);
  if (num_bytes_ < sizeof(JobFileHead) || num_bytes_ > size ||
      size - num_bytes_ != num_chunks * sizeof(uint64_t) + sizeof(tail)) {
    ThrowDamaged();
  }
  checksums_.resize(num_chunks);
  ReadUnchecked(num_bytes_, num_chunks * sizeof(uint64_t), checksums_.data());
  if (TailChecksum(checksums_, tail.num_bytes, tail.num_sections) !=
      tail.checksum) {
    ThrowDamaged();
  }
  return tail.num_sections;
}

// Whole chunks are read into place at once, those at both ends into a buffer.
void JobFileReader::ReadBytes(uint64_t offset, size_t num_bytes,
                              void* bytes) const {
  char* to = static_cast<char*>(bytes);
  std::array<char, kJobFileChunk> buffer;
  while (num_bytes > 0) {
    const uint64_t chunk = offset / kJobFileChunk;
    const uint64_t begin = chunk * kJobFileChunk;
    const size_t chunk_size =
        std::min<uint64_t>(kJobFileChunk, num_bytes_ - begin);
    const size_t skip = offset - begin;
    size_t count = std::min(num_bytes, chunk_size - skip);
    if (count < kJobFileChunk) {
      ReadUnchecked(begin, chunk_size, buffer.data());
      CheckChunk(chunk, buffer.data(), chunk_size);
      std::memcpy(to, buffer.data() + skip, count);
    } else {
      count = num_bytes / kJobFileChunk * kJobFileChunk;
      ReadUnchecked(offset, count, to);
      for (size_t i = 0; i < count / kJobFileChunk; ++i) {
        CheckChunk(chunk + i, to + i * kJobFileChunk, kJobFileChunk);
      }
    }
    offset += count;
    to += count;
    num_bytes -= count;
  }
}

void JobFileReader::CheckChunk(uint64_t chunk, const char* bytes,
                               size_t num_bytes) const {
  if (HashBytes({bytes, num_bytes}) != checksums_[chunk]) {
    ThrowDamaged();
  }
}

void JobFileReader::Throw(const std::string& what) const {
  throw FileError(file_.path, what + ": " + file_.kind.what_to_do);
}

void JobFileReader::ThrowDamaged() const { Throw("truncated or damaged"); }

void JobFileReader::ReadUnchecked(uint64_t offset, size_t num_bytes,
                                  void* bytes) const {
  size_t num_read = 0;
  while (num_read < num_bytes) {
    const ssize_t count =
        pread(descriptor_.value, static_cast<char*>(bytes) + num_read,
              num_bytes - num_read, static_cast<off_t>(offset + num_read));
    if (count == 0) {
      ThrowDamaged();
    }
    if (count < 0 && errno != EINTR) {
      throw FileError(file_.path,
                      std::string("can not be read: ") + std::strerror(errno));
    }
    num_read += count > 0 ? static_cast<size_t>(count) : 0;
  }
}

bool JobFile::Exists() const {
  try {
    const JobFileReader reader(*this);
    return true;
  } catch (const FileError&) {
    return false;
  }
}

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
