#pragma once

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "colmap_ext/report/html_page.h"
#include "formats/picture_files.h"
#include "scene/view.h"
#include "tests/report/well_formed.h"

namespace colmap_ext {

// The stand-alone program, and after it COLMAP's, if that is patched.
inline const std::string kProgram = COLMAP_EXT_PROGRAM;
inline std::vector<std::string> Programs() {
  std::vector<std::string> programs = {kProgram};
#ifdef COLMAP_EXT_COLMAP_PROGRAM
  programs.emplace_back(COLMAP_EXT_COLMAP_PROGRAM);
#endif
  return programs;
}

// As one word of a command line.
inline std::string Quote(const std::filesystem::path& path) {
  return "\"" + path.string() + "\"";
}

// " --option PATH"
inline std::string PathOption(const std::string& option,
                              const std::filesystem::path& path) {
  return " --" + option + " " + Quote(path);
}

// What a command line did.
struct Outcome {
  int exit_code = -1;  // 134 is an abort
  std::string out;
  std::string err;
};

inline Outcome RunShell(const std::string& command) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.Path() / "out";
  const std::filesystem::path err = folder.Path() / "err";
  const std::string redirected =
      command + " >" + Quote(out) + " 2>" + Quote(err) + " </dev/null";
  const int status = std::system(redirected.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(out),
          ReadFile(err)};
}

// A command line of the program. "@" stands for the section of the command's
// own options, as in "mesh_planner @max_proj_dist 0".
inline std::string CommandLine(const std::string& arguments,
                               const std::string& program = kProgram) {
  const std::string section =
      arguments.starts_with("facetwise")        ? "FacetwiseRefinement."
      : arguments.starts_with("mesh_evaluator") ? "MeshEvaluation."
                                                : "DelaunayManifoldMeshing.";
  std::string line = Quote(program) + " " + arguments;
  for (size_t at = line.find(" @"); at != std::string::npos;
       at = line.find(" @", at)) {
    line.replace(at, 2, " --" + section);
  }
  return line;
}

inline Outcome RunProgram(const std::string& arguments) {
  return RunShell(CommandLine(arguments));
}

// Fails, where it is called, unless the command succeeded.
inline Outcome Succeed(Outcome outcome, const char* file = __builtin_FILE(),
                       int line = __builtin_LINE()) {
  if (outcome.exit_code != 0) {
    ADD_FAILURE_AT(file, line) << "exit code " << outcome.exit_code << "\n"
                               << outcome.out << outcome.err;
  }
  return outcome;
}

// Fails unless the command gave one line that says so, and exit code 1.
inline void ExpectRefusal(const Outcome& outcome, const std::string& message) {
  EXPECT_EQ(outcome.exit_code, 1) << message;
  EXPECT_TRUE(HasAll(outcome.err, {"ERROR: ", message}));
  EXPECT_EQ(Count(outcome.err, "\n"), 1) << outcome.err;
}

// The same where no file may be larger: a limit on the size of files stands for
// a full disk.
inline void ExpectFullDisk(const std::string& command,
                           uintmax_t max_file_size) {
  ExpectRefusal(RunShell("trap '' XFSZ; prlimit --fsize=" +
                         std::to_string(max_file_size) + " " + command),
                "File too large");
}

// A mesh with its .vis.
inline std::string BytesOf(const std::filesystem::path& mesh_path) {
  return ReadFile(mesh_path) + ReadFile(mesh_path.string() + ".vis");
}

// Writes the mask of an image, which leaves out a share of it from above.
inline void WriteMask(const std::filesystem::path& folder, const View& view,
                      double share) {
  ColorImage mask{view.width, view.height, {}};
  for (int i = 0; i < view.width * view.height; ++i) {
    const uint8_t value = i < share * view.width * view.height ? 0 : 255;
    mask.pixels.push_back({value, value, value});
  }
  WriteFile(folder / (view.name + ".png"), EncodePng(mask));
}

// Fails unless the page is well-formed, needs nothing from elsewhere, and says
// all that the command has printed in its report.
inline void ExpectPageOfRun(const std::string& page, const Outcome& outcome) {
  EXPECT_EQ(XmlDefect(page), "");
  // With a colon, which pictures in base 64 do not have.
  EXPECT_TRUE(HasNone(page, {"http:", "https:", "url(", "<link", "<script"}));
  EXPECT_LT(page.size(), 10'000'000);
  size_t num_rows = 0;
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) {
      continue;
    }
    ++num_rows;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      EXPECT_TRUE(Has(page, EscapeHtml(word)));
    }
  }
  EXPECT_GT(num_rows, 20);
}

// The first number after a text; a failure if it has none.
inline double NumberAfter(const std::string& key, const std::string& text) {
  const size_t at = text.find(key);
  if (at == std::string::npos) {
    ADD_FAILURE() << "no '" << key << "' in\n" << text;
    return std::nan("");
  }
  return std::stod(text.substr(at + key.size()));
}

// A program while it runs, which waits after each line that it prints until the
// line is read: its standard output is a pipe of packets with room for one.
class Process {
 public:
  // \param err  the file for its standard error.
  Process(const std::string& command_line, const std::filesystem::path& err) {
    const std::string command = "exec " + command_line;
    int ends[2];
    if (pipe2(ends, O_DIRECT | O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe");
    }
    fcntl(ends[1], F_SETPIPE_SZ, 1);  // rounded up to one page
    id_ = fork();
    if (id_ == 0) {
      for (const int number : {SIGINT, SIGTERM}) {
        std::signal(number, SIG_DFL);
      }
      dup2(ends[1], 1);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
  }
  ~Process() { close(output_); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Reads what the program prints until that has the text.
  // \return whether it has.
  bool WaitFor(const std::string& text) {
    std::string printed;
    while (printed.find(text) == std::string::npos) {
      if (!Read(&printed)) {
        return false;
      }
    }
    return true;
  }

  void Signal(int number) const { kill(id_, number); }

  // Reads what is left. As waitpid() has it.
  int Wait() {
    for (std::string rest; Read(&rest);) {
    }
    int status = 0;
    waitpid(id_, &status, 0);
    return status;
  }

 private:
  bool Read(std::string* printed) const {
    char packet[PIPE_BUF];
    const ssize_t size = read(output_, packet, sizeof(packet));
    printed->append(packet, size > 0 ? static_cast<size_t>(size) : 0);
    return size > 0;
  }

  pid_t id_ = 0;
  int output_ = -1;
};

}  // namespace colmap_ext
