#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace colmap_ext {

// A file that appears under its name when it is complete, or not at all: it is
// written beside its place under a temporary name, which goes away with the
// object, or with the program when that is interrupted (SIGINT, SIGTERM,
// SIGHUP). A file that was there before stays as it is until then.
class AtomicFile {
 public:
  // \throw FileError if the folder is not there or not writable, or the path
  //        is that of something else than a file.
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // \throw FileError if the disk is full, or fails.
  void Write(const void* bytes, size_t num_bytes);

  template <typename T>
  void Write(const T& value) {
    Write(&value, sizeof(T));
  }

 private:
  friend class AtomicFiles;

  void Flush();
  void Sync();
  void Rename();

  std::filesystem::path path_;
  std::string temporary_path_;
  int descriptor_ = -1;
  int cleanup_slot_ = -1;
  std::vector<char> buffer_;
};

// Files that belong together: if one of them cannot be written, none appears.
class AtomicFiles {
 public:
  // \throw FileError as AtomicFile
  AtomicFile* Add(const std::filesystem::path& path);

  // All of them reach the disk. Nothing is written to them afterwards.
  // \throw FileError if the disk is full, or fails.
  void Sync();

  // The same, and gives them their names, in the order in which they were
  // added.
  // \throw FileError if that fails.
  void Commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

// Writes a whole file.
// \param together  to which it is added, for a Commit() later; nullptr: it
//        appears at once
// \throw FileError if it cannot be written.
void WriteText(const std::filesystem::path& path, const std::string& text,
               AtomicFiles* together = nullptr);

// Ends the program as the signal does where nothing handles it, but removes the
// temporary files before. May be called by a signal handler.
void DieOfSignal(int signal);

// Called before hours of work, so that an unwritable output fails early.
// \throw FileError if an AtomicFile would.
void ExpectWritable(const std::filesystem::path& path);

}  // namespace colmap_ext
