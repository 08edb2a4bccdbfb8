#include "formats/byte_reader.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

constexpr size_t kReadBufferSize = 1 << 18;  // bytes

}  // namespace

void ExpectRegularFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status =
      std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw FileError(path, "no such file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw FileError(path, "not a regular file");
  }
}

ByteReader::ByteReader(const std::filesystem::path& path) : path_(path) {
  ExpectRegularFile(path);
  file_.open(path, std::ios::binary);
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (!file_ || error) {
    throw FileError(path, "cannot be read");
  }
  buffer_.resize(std::min<uint64_t>(kReadBufferSize, size_));
}

void ByteReader::Skip(uint64_t num_bytes, const char* what) {
  if (num_bytes > Remaining()) {
    ThrowTruncated(what);
  }
  const size_t num_buffered = buffer_end_ - buffer_begin_;
  position_ += num_bytes;
  if (num_bytes <= num_buffered) {
    buffer_begin_ += num_bytes;
  } else {
    buffer_begin_ = buffer_end_ = 0;
    file_.seekg(static_cast<std::streamoff>(position_));
  }
}

uint64_t ByteReader::ReadCount(uint64_t min_bytes_each, const char* what) {
  const uint64_t count = Read<uint64_t>(what);
  if (count > Remaining() / min_bytes_each) {
    Throw(fmt::format(
        "truncated or damaged: it promises {} {}, but has room for {}", count,
        what, Remaining() / min_bytes_each));
  }
  return count;
}

void ByteReader::ExpectEnd() const {
  if (Remaining() > 0) {
    Throw(
        fmt::format("damaged: it has {} bytes more than its counts account for",
                    Remaining()));
  }
}

void ByteReader::Take(char* bytes, size_t num_bytes) {
  std::memcpy(bytes, buffer_.data() + buffer_begin_, num_bytes);
  buffer_begin_ += num_bytes;
  position_ += num_bytes;
}

void ByteReader::ReadAcrossBuffers(char* bytes, size_t num_bytes,
                                   const char* what) {
  if (num_bytes > Remaining()) {
    ThrowTruncated(what);
  }
  while (num_bytes > 0) {
    if (buffer_begin_ == buffer_end_) {
      FillBuffer(what);
    }
    const size_t num_now = std::min(num_bytes, buffer_end_ - buffer_begin_);
    Take(bytes, num_now);
    bytes += num_now;
    num_bytes -= num_now;
  }
}

void ByteReader::FillBuffer(const char* what) {
  file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_begin_ = 0;
  buffer_end_ = static_cast<size_t>(file_.gcount());
  if (buffer_end_ == 0) {  // it shrank, or the disk fails
    ThrowTruncated(what);
  }
  file_.clear();
}

void ByteReader::ThrowTruncated(const char* what) const {
  Throw(fmt::format("truncated: it ends in the middle of {} (at byte {} of {})",
                    what, position_, size_));
}

}  // namespace colmap_ext
