#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
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
  friend void Commit(std::span<AtomicFile* const> files);

  void Flush();
  void Sync();
  void Rename();

  std::filesystem::path path_;
  std::string temporary_path_;
  int descriptor_ = -1;
  int cleanup_slot_ = -1;
  std::vector<char> buffer_;
};

// Gives the files their names, in this order, after all of them have reached
// the disk.
// \throw FileError if that fails.
void Commit(std::span<AtomicFile* const> files);

// Writes a whole file.
// \throw FileError if it can not be written.
void WriteText(const std::filesystem::path& path, const std::string& text);

// Ends the program as the signal does where nothing handles it, but removes the
// temporary files before. May be called by a signal handler.
void DieOfSignal(int signal);

// Called before hours of work, so that an unwritable output fails early.
// \throw FileError if an AtomicFile would.
void ExpectWritable(const std::filesystem::path& path);

}  // namespace colmap_ext
