#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "formats/atomic_file.h"

namespace colmap_ext {

// A binary file of a plan: 8 bytes that name the kind, the identity of the
// plan, the number of sections, and the sections, each after its number of
// bytes. Then a checksum of each kSectionChunk bytes of all that, and finally
// a checksum of these checksums, and the number of bytes. Little-endian.
inline constexpr size_t kSectionChunk = 8192;

// Values are written as they are in memory: boxes as their two corners.
static_assert(sizeof(Eigen::AlignedBox3f) == 6 * sizeof(float));

// Writes one. It appears complete or not at all.
class SectionWriter {
 public:
  // \param kind  8 characters
  // \throw FileError as AtomicFile
  SectionWriter(const std::filesystem::path& path, const std::string& kind,
                uint64_t identity, uint64_t num_sections);

  // \throw FileError if the disk is full
  template <typename T>
  void Add(const std::vector<T>& values) {
    const uint64_t num_bytes = values.size() * sizeof(T);
    Write(&num_bytes, sizeof(num_bytes));
    Write(values.data(), num_bytes);
  }

  // \throw FileError
  void Commit();

 private:
  void Write(const void* bytes, size_t num_bytes);
  void EndChunk();

  AtomicFiles files_;
  AtomicFile* file_;         // of files_
  std::vector<char> chunk_;  // that is not complete
  std::vector<uint64_t> checksums_;
  uint64_t num_bytes_ = 0;
};

// Reads one, and checks what it reads. Safe from several threads.
class SectionReader {
 public:
  // \throw FileError if the file is missing, damaged, or of another kind or
  //        plan
  SectionReader(const std::filesystem::path& path, const std::string& kind,
                uint64_t identity, uint64_t num_sections);

  // How many values of a type a section has.
  template <typename T>
  size_t Count(size_t section) const {
    return sizes_[section] / sizeof(T);
  }

  // \pre the section has so many
  // \throw FileError if the file can not be read, or is damaged there
  template <typename T>
  std::vector<T> Read(size_t section, size_t begin, size_t end) const {
    std::vector<T> values(end - begin);
    ReadBytes(offsets_[section] + begin * sizeof(T), values.size() * sizeof(T),
              values.data());
    return values;
  }

  template <typename T>
  std::vector<T> ReadAll(size_t section) const {
    return Read<T>(section, 0, Count<T>(section));
  }

 private:
  // An open file, closed with the object.
  struct Descriptor {
    int value = -1;
    Descriptor() = default;
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
  };

  void ReadChecksums(uint64_t size);
  void ReadBytes(uint64_t offset, size_t num_bytes, void* bytes) const;
  void ReadUnchecked(uint64_t offset, size_t num_bytes, void* bytes) const;
  void CheckChunk(uint64_t chunk, const char* bytes, size_t num_bytes) const;
  [[noreturn]] void ThrowDamaged() const;

  std::filesystem::path path_;
  Descriptor descriptor_;
  uint64_t num_bytes_ = 0;           // that have checksums
  std::vector<uint64_t> checksums_;  // of each kSectionChunk of them
  std::vector<uint64_t> offsets_;    // [sections], bytes
  std::vector<uint64_t> sizes_;      // [sections], bytes
};

// Whether there is such a file of the plan.
bool HasSections(const std::filesystem::path& path, const std::string& kind,
                 uint64_t identity, uint64_t num_sections);

}  // namespace colmap_ext
