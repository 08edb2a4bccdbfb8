#include "colmap_ext/jobs/job_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include "base/mix_bits.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

std::string ValueIn(const JobInputs::Values& values, const std::string& name) {
  const auto found = values.find(name);
  return found != values.end() ? found->second : "";
}

std::string Difference(const JobInputs::Values& before,
                       const JobInputs::Values& now) {
  JobInputs::Values all = before;
  all.insert(now.begin(), now.end());
  for (const auto& [name, value] : all) {
    const std::string was = ValueIn(before, name);
    const std::string is = ValueIn(now, name);
    if (was != is) {
      return fmt::format("{} was '{}' and is '{}'", name, was, is);
    }
  }
  return "";
}

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
  return HashValues(words);
}

}  // namespace

uint64_t HashBytes(std::string_view bytes, uint64_t hash) {
  // Four sums, because a processor computes as many at a time.
  std::array<uint64_t, 4> sums = {1, 2, 3, 4};
  for (size_t i = 0; i < bytes.size(); i += sizeof(sums)) {
    std::array<uint64_t, 4> words = {};
    std::memcpy(words.data(), bytes.data() + i,
                std::min(sizeof(sums), bytes.size() - i));
    for (size_t k = 0; k < 4; ++k) {
      sums[k] = (sums[k] ^ words[k]) * kSplitMixStep;
      sums[k] ^= sums[k] >> 32;
    }
  }
  hash = MixBits(hash + bytes.size());
  for (const uint64_t sum : sums) {
    hash = MixBits(hash + sum);
  }
  return hash;
}

std::string Fingerprint(const fs::path& path) {
  constexpr uint64_t kNumSamples = 64;
  constexpr uint64_t kSampleBytes = 1 << 18;
  std::error_code error;
  const uint64_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    return "none";
  }
  constexpr uint64_t kGaps = kNumSamples - 1;
  const uint64_t last = size - std::min(size, kSampleBytes);
  const uint64_t step = std::max(kSampleBytes, (last + kGaps - 1) / kGaps);
  uint64_t hash = 0;
  std::string sample(std::min(size, kSampleBytes), '\0');
  for (uint64_t begin = 0; begin < size; begin += step) {
    file.clear();
    file.seekg(static_cast<std::streamoff>(begin));
    file.read(sample.data(), static_cast<std::streamsize>(sample.size()));
    hash = HashBytes({sample.data(), static_cast<size_t>(file.gcount())}, hash);
  }
  return fmt::format("{} bytes, hash {:016x}", size, hash);
}

void JobInputs::AddFiles(
    const std::vector<std::pair<std::string, fs::path>>& named) {
  std::vector<std::string> fingerprints(named.size());
  tbb::parallel_for(size_t{0}, named.size(), [&](size_t i) {
    fingerprints[i] = Fingerprint(named[i].second);
  });
  for (size_t i = 0; i < named.size(); ++i) {
    files[named[i].first] = fingerprints[i];
  }
}

void JobInputs::AddFiles(const std::vector<fs::path>& paths) {
  std::vector<std::pair<std::string, fs::path>> named;
  for (const fs::path& path : paths) {
    named.emplace_back(fs::absolute(path).string(), path);
  }
  AddFiles(named);
}

void JobInputs::SetOptions(const CommandOptions& command, const fs::path& path,
                           const std::string& what_to_do) const {
  for (const CommandOptions::Option& option : command.Options()) {
    const auto found = options.find(option.name);
    if (found != options.end() && !option.set(found->second)) {
      throw FileError(path, "damaged at " + option.name + ": " + what_to_do);
    }
  }
}

std::string JobInputs::DifferenceTo(const JobInputs& earlier) const {
  const std::string difference = Difference(earlier.options, options);
  return difference.empty() ? Difference(earlier.files, files) : difference;
}

uint64_t JobInputs::Hash(int version) const {
  uint64_t hash = HashBytes(std::to_string(version));
  for (const Values* values : {&options, &files}) {
    for (const auto& [name, value] : *values) {
      hash = HashBytes(fmt::format("{}={}\n", name, value), hash);
    }
  }
  return hash;
}

void WriteSections(const JobFile& job_file,
                   const std::vector<JobFileSection>& sections) {
  AtomicFiles files;
  AtomicFile* const file = files.Add(job_file.path);
  std::vector<char> chunk;  // that is not complete
  std::vector<uint64_t> checksums;
  uint64_t num_bytes = 0;
  const auto end_chunk = [&] {
    checksums.push_back(HashValues(chunk));
    chunk.clear();
  };
  const auto write = [&](JobFileSection bytes) {
    file->Write(bytes.data(), bytes.size());
    num_bytes += bytes.size();
    while (!bytes.empty()) {
      const size_t count = std::min(bytes.size(), kJobFileChunk - chunk.size());
      chunk.insert(chunk.end(), bytes.data(), bytes.data() + count);
      bytes = bytes.subspan(count);
      if (chunk.size() == kJobFileChunk) {
        end_chunk();
      }
    }
  };
  const uint64_t identity = FileIdentity(job_file);
  write({job_file.kind.name, kKindLength});
  write({reinterpret_cast<const char*>(&identity), sizeof(identity)});
  std::vector<uint64_t> sizes;  // bytes
  for (const JobFileSection& section : sections) {
    write(section);
    sizes.push_back(section.size());
  }
  write({reinterpret_cast<const char*>(sizes.data()),
         sizes.size() * sizeof(uint64_t)});
  if (!chunk.empty()) {
    end_chunk();
  }
  file->Write(checksums.data(), checksums.size() * sizeof(uint64_t));
  file->Write(JobFileTail{TailChecksum(checksums, num_bytes, sizes.size()),
                          num_bytes, sizes.size()});
  files.Commit();
}

JobFileReader::JobFileReader(JobFile file) : file_(std::move(file)) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file_.path, error);
  descriptor_.value = open(file_.path.c_str(), O_RDONLY | O_CLOEXEC);
  if (error || descriptor_.value < 0) {
    throw FileError(
        file_.path,
        "cannot be read: " + (error ? error.message() : std::strerror(errno)));
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

Descriptor::~Descriptor() {
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
                      std::string("cannot be read: ") + std::strerror(errno));
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

FolderLock::FolderLock(const fs::path& folder) {
  descriptor_.value =
      open((folder / "plan.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_.value < 0) {
    throw FileError(folder, "cannot be written");
  }
  is_locked_ = flock(descriptor_.value, LOCK_EX | LOCK_NB) == 0;
  if (!is_locked_ && errno == EWOULDBLOCK) {
    throw FileError(folder, "another planner is at work there");
  }
}

}  // namespace colmap_ext
