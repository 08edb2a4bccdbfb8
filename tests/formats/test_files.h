#pragma once

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "formats/errors.h"
#include "tests/texts.h"

namespace colmap_ext {

// A folder of its own for each test, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string path =
        (std::filesystem::temp_directory_path() / "colmap_ext_XXXXXX").string();
    if (mkdtemp(path.data()) == nullptr) {
      throw std::runtime_error("no temporary folder");
    }
    path_ = path;
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// A test with a folder of its own.
struct FolderTest : testing::Test {
  // \param name  of the file of the test; empty: the folder itself.
  explicit FolderTest(const std::string& name = "")
      : path_(name.empty() ? folder_.Path() : folder_.Path() / name) {}

  const TemporaryFolder folder_;
  const std::filesystem::path path_;
};

inline void WriteFile(const std::filesystem::path& path,
                      std::string_view bytes) {
  if (path.has_parent_path()) {
    std::filesystem::create_directories(path.parent_path());
  }
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Names of all that is in a folder, sorted, separated by spaces.
inline std::string List(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  std::string list;
  for (const std::string& name : names) {
    list += (list.empty() ? "" : " ") + name;
  }
  return list;
}

// The bytes of all files in a folder and below it; folders have none.
inline std::map<std::filesystem::path, std::string> FilesOf(
    const std::filesystem::path& folder) {
  std::map<std::filesystem::path, std::string> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(folder)) {
    files[entry.path()] = entry.is_directory() ? "" : ReadFile(entry.path());
  }
  return files;
}

// Appends a number as it lies in memory, that is little-endian.
template <typename T>
void Append(T value, std::string* bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes->append(raw, sizeof(T));
}

// Expects that the function throws a FileError whose message has the text.
template <typename Function>
void ExpectFileError(const std::string& text, Function function) {
  EXPECT_TRUE(Has(MessageOf<FileError>(function), text));
}

// Runs the function in a process of its own, which exits with 7 if that throws
// a FileError.
// \return as waitpid() has it: how the process ended.
inline int RunInChild(const std::function<void()>& function) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      function();
    } catch (const FileError&) {
      _exit(7);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

// Whether the function throws a FileError where no file may be larger: a limit
// on the size of files stands for a full disk. Runs it in a process of its own.
inline bool FailsOnAFullDisk(size_t max_file_size,
                             const std::function<void()>& function) {
  const int status = RunInChild([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {max_file_size, max_file_size};
    setrlimit(RLIMIT_FSIZE, &limit);
    function();
  });
  return WIFEXITED(status) && WEXITSTATUS(status) == 7;
}

// Reads a file cut off after each of its bytes but the last ones, where every
// length has to be refused, and nothing else may happen.
//
// \param num_optional  bytes at the end that may be missing.
template <typename Function>
void ExpectEveryTruncationRefused(const std::filesystem::path& path,
                                  size_t num_optional, Function read) {
  const std::string bytes = ReadFile(path);
  for (size_t size = 0; size + num_optional < bytes.size(); ++size) {
    WriteFile(path, std::string_view(bytes).substr(0, size));
    EXPECT_THROW(read(), FileError) << path << " cut to " << size << " bytes";
  }
  WriteFile(path, bytes);
  EXPECT_NO_THROW(read());
}

}  // namespace colmap_ext
