#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/rows.h"
#include "colmap_ext/options/command_options.h"

namespace colmap_ext {

// A hash that detects accidental changes; it offers no security.
// \param hash  of the bytes before
uint64_t HashBytes(std::string_view bytes, uint64_t hash = 0);

// The same of values as they are in memory.
template <typename T>
uint64_t HashValues(const std::vector<T>& values, uint64_t hash = 0) {
  return HashBytes(
      {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)},
      hash);
}

// The size of a file and a hash of its bytes, as "N bytes, hash H"; "none" if
// it cannot be read. Files of more than 16 MB are sampled at 64 places.
std::string Fingerprint(const std::filesystem::path& path);

// All that the result of a job depends on, except the program itself and its
// backend. A job whose inputs differ does not use files of another.
struct JobInputs {
  using Values = std::map<std::string, std::string>;

  Values options;  // as they are typed, by name
  Values files;    // fingerprints, by name or path

  // \param add  adds the options of a command to the former
  template <typename T>
  void AddOptions(void (*add)(CommandOptions*, T*), T values) {
    CommandOptions command;
    add(&command, &values);
    for (const CommandOptions::Option& option : command.Options()) {
      options[option.name] = option.text();
    }
  }

  // Computes the fingerprints in parallel.
  void AddFiles(
      const std::vector<std::pair<std::string, std::filesystem::path>>& named);
  // The same by absolute paths.
  void AddFiles(const std::vector<std::filesystem::path>& paths);

  // Sets those of a command's options that are inputs.
  // \param path  of the file that they come from
  // \param what_to_do  if it is damaged
  // \throw FileError if one has no valid value
  void SetOptions(const CommandOptions& command,
                  const std::filesystem::path& path,
                  const std::string& what_to_do) const;

  // The first difference to the inputs of an earlier job, as "iterations was
  // '10' and is '3'"; empty: none.
  std::string DifferenceTo(const JobInputs& earlier) const;

  // \param version  of the job's files
  uint64_t Hash(int version) const;
};

// The one binary file of all jobs: 8 bytes that name its kind, a hash of its
// name and the identity of its job, and sections of values as they are in
// memory, little-endian, and their sizes. Then a checksum of each kJobFileChunk
// bytes of all that, and finally a checksum of these checksums and of two
// counts, and the counts.
inline constexpr size_t kJobFileChunk = 8192;

struct JobFileKind {
  const char* name;        // 8 characters, with the version of the format
  const char* what_to_do;  // if the file is damaged, or of another job
};

// A file of a job.
struct JobFile {
  std::filesystem::path path;
  JobFileKind kind;
  uint64_t identity = 0;  // of the job

  // Whether it exists, of this kind and job.
  bool Exists() const;
};

// An open file, closed with the object.
struct Descriptor {
  int value = -1;
  Descriptor() = default;
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

static_assert(sizeof(Eigen::AlignedBox3f) == 6 * sizeof(float));

// A section of a file, as it is in memory.
using JobFileSection = std::span<const char>;

template <typename T>
void AddSections(const std::vector<T>& values,
                 std::vector<JobFileSection>* sections) {
  sections->emplace_back(reinterpret_cast<const char*>(values.data()),
                         values.size() * sizeof(T));
}
template <typename T>
void AddSections(const Rows<T>& rows, std::vector<JobFileSection>* sections) {
  AddSections(rows.offsets, sections);
  AddSections(rows.values, sections);
}
template <typename T>
void AddSections(const T& value, std::vector<JobFileSection>* sections) {
  sections->emplace_back(reinterpret_cast<const char*>(&value), sizeof(T));
}

// Writes a file of these sections. It appears complete or not at all.
// \throw FileError if it cannot be written
void WriteSections(const JobFile& file,
                   const std::vector<JobFileSection>& sections);

// Writes a file of a section for each value, two for rows.
// \throw FileError if it cannot be written
template <typename... T>
void WriteJobFile(const JobFile& file, const T&... values) {
  std::vector<JobFileSection> sections;
  (AddSections(values, &sections), ...);
  WriteSections(file, sections);
}

// Reads one, and checks what it reads. Safe from several threads.
class JobFileReader {
 public:
  // \throw FileError if the file is missing, damaged, renamed, or of another
  //        kind or job
  explicit JobFileReader(JobFile file);

  // Number of values of a type in a section.
  template <typename T>
  size_t Count(size_t section) const {
    return (offsets_.at(section + 1) - offsets_[section]) / sizeof(T);
  }

  // \pre the section has as many values
  // \throw FileError if the file cannot be read, or is damaged there
  template <typename T>
  std::vector<T> Read(size_t section, size_t begin, size_t end) const {
    std::vector<T> values(end - begin);
    ReadBytes(offsets_[section] + begin * sizeof(T), values.size() * sizeof(T),
              values.data());
    return values;
  }

  // The same of a section that may be empty; no values then.
  template <typename T>
  std::vector<T> ReadIfAny(size_t section, size_t begin, size_t end) const {
    return Count<T>(section) > 0 ? Read<T>(section, begin, end)
                                 : std::vector<T>();
  }

  template <typename T>
  std::vector<T> ReadAll(size_t section) const {
    return Read<T>(section, 0, Count<T>(section));
  }

  // Reads consecutive sections as WriteJobFile() wrote them.
  template <typename... T>
  void ReadFrom(size_t section, T*... values) const {
    (ReadOne(&section, values), ...);
  }

 private:
  template <typename T>
  void ReadOne(size_t* section, std::vector<T>* values) const {
    *values = ReadAll<T>((*section)++);
  }
  template <typename T>
  void ReadOne(size_t* section, Rows<T>* rows) const {
    ReadOne(section, &rows->offsets);
    ReadOne(section, &rows->values);
  }
  template <typename T>
  void ReadOne(size_t* section, T* value) const {
    ReadBytes(offsets_[(*section)++], sizeof(T), value);
  }

  uint64_t ReadChecksums(uint64_t size);
  void ReadBytes(uint64_t offset, size_t num_bytes, void* bytes) const;
  void ReadUnchecked(uint64_t offset, size_t num_bytes, void* bytes) const;
  void CheckChunk(uint64_t chunk, const char* bytes, size_t num_bytes) const;
  [[noreturn]] void Throw(const std::string& what) const;
  [[noreturn]] void ThrowDamaged() const;

  JobFile file_;
  Descriptor descriptor_;
  uint64_t num_bytes_ = 0;           // that have checksums
  std::vector<uint64_t> checksums_;  // of each kJobFileChunk of them
  std::vector<uint64_t> offsets_;    // [sections + 1], bytes
};

// While it exists, no other process can plan a meshing or a refinement in the
// folder. Has no effect on network file systems without locks.
class FolderLock {
 public:
  // \throw FileError if another has it, or the folder cannot be written
  explicit FolderLock(const std::filesystem::path& folder);

  // Whether the lock is held; false on a file system without locks.
  bool IsLocked() const { return is_locked_; }

 private:
  Descriptor descriptor_;
  bool is_locked_ = false;
};

// The warning if the file system has no locks.
inline constexpr char kNoLocks[] =
    "the plan's file system has no locks (flock): do not run two planners in "
    "its folder at once";

}  // namespace colmap_ext
