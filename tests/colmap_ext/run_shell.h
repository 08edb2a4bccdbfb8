#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/view.h"
#include "tests/texts.h"

namespace colmap_ext {

// The stand-alone program, and after it COLMAP's, if that is patched.
inline const std::string kProgram = COLMAP_EXT_PROGRAM;
std::vector<std::string> Programs();

// As one word of a command line.
std::string Quote(const std::filesystem::path& path);

// " --option PATH"
std::string PathOption(const std::string& option,
                       const std::filesystem::path& path);

// What a command line did.
struct Outcome {
  int exit_code = -1;  // 134 is an abort
  std::string out;
  std::string err;
};

Outcome RunShell(const std::string& command);

// A command line of the program. "@" stands for the section of the command's
// own options, as in "mesh_planner @max_proj_dist 0".
std::string CommandLine(const std::string& arguments,
                        const std::string& program = kProgram);

inline Outcome RunProgram(const std::string& arguments) {
  return RunShell(CommandLine(arguments));
}

// Fails, where it is called, unless the command succeeded.
Outcome Succeed(Outcome outcome, const char* file = __builtin_FILE(),
                int line = __builtin_LINE());

// Fails unless the command gave one line that says so, and exit code 1.
void ExpectRefusal(const Outcome& outcome, const std::string& message);

// The same where no file may be larger: a limit on the size of files stands for
// a full disk.
void ExpectFullDisk(const std::string& command, uintmax_t max_file_size);

// A mesh with its .vis.
std::string BytesOf(const std::filesystem::path& mesh_path);

// Writes the mask of an image, which leaves out a share of it from above.
void WriteMask(const std::filesystem::path& folder, const View& view,
               double share);

// Fails unless the page is well-formed, needs nothing from elsewhere, and says
// all that the command has printed in its report.
void ExpectPageOfRun(const std::string& page, const Outcome& outcome);

// The first number after a text; a failure if it has none.
double NumberAfter(const std::string& key, const std::string& text);

// A program while it runs, which waits after each line that it prints until the
// line is read: its standard output is a pipe of packets with room for one.
class Process {
 public:
  // \param err  the file for its standard error.
  Process(const std::string& command_line, const std::filesystem::path& err);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Reads what the program prints until that has the text.
  // \return whether it has.
  bool WaitFor(const std::string& text);

  void Signal(int number) const;

  // Reads what is left. As waitpid() has it.
  int Wait();

 private:
  bool Read(std::string* printed) const;

  pid_t id_ = 0;
  int output_ = -1;
};

}  // namespace colmap_ext
