#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "formats/errors.h"

namespace colmap_ext {

// A folder of its own for each test, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// A test with a folder of its own.
class FolderTest : public testing::Test {
 protected:
  // \param name  of the file of the test; empty: the folder itself.
  explicit FolderTest(const std::string& name = "")
      : path_(name.empty() ? folder_.Path() : folder_.Path() / name) {}

  const TemporaryFolder folder_;
  const std::filesystem::path path_;
};

void WriteFile(const std::filesystem::path& path, std::string_view bytes);

std::string ReadFile(const std::filesystem::path& path);

// Names of all that is in a folder, sorted, separated by spaces.
std::string List(const std::filesystem::path& folder);

// The bytes of all files in a folder and below it; folders have none.
std::map<std::filesystem::path, std::string> FilesOf(
    const std::filesystem::path& folder);

// Appends a number as it lies in memory, that is little-endian.
template <typename T>
void Append(T value, std::string* bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes->append(raw, sizeof(T));
}

// The message of the FileError that the function throws; a failure if it throws
// anything else or nothing.
template <typename Function>
std::string FileErrorOf(Function function) {
  try {
    function();
    ADD_FAILURE() << "no error";
  } catch (const FileError& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another error: " << error.what();
  }
  return "";
}

// Expects that the function throws a FileError whose message has the text.
template <typename Function>
void ExpectFileError(const std::string& text, Function function) {
  const std::string error = FileErrorOf(function);
  EXPECT_NE(error.find(text), std::string::npos)
      << "expected: " << text << "\nfound: " << error;
}

// Runs the function in a process of its own, which exits with 7 if that throws
// a FileError.
// \return as waitpid() has it: how the process ended.
int RunInChild(const std::function<void()>& function);

// Whether the function throws a FileError where no file may be larger: a limit
// on the size of files stands for a full disk. Runs it in a process of its own.
bool FailsOnAFullDisk(size_t max_file_size,
                      const std::function<void()>& function);

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
