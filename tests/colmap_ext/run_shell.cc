#include "tests/colmap_ext/run_shell.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <sstream>
#include <stdexcept>

#include "colmap_ext/report/html_page.h"
#include "formats/picture_files.h"
#include "tests/formats/test_files.h"
#include "tests/report/well_formed.h"

namespace colmap_ext {

std::vector<std::string> Programs() {
  std::vector<std::string> programs = {kProgram};
#ifdef COLMAP_EXT_COLMAP_PROGRAM
  programs.emplace_back(COLMAP_EXT_COLMAP_PROGRAM);
#endif
  return programs;
}

std::string Quote(const std::filesystem::path& path) {
  return "\"" + path.string() + "\"";
}

std::string PathOption(const std::string& option,
                       const std::filesystem::path& path) {
  return " --" + option + " " + Quote(path);
}

std::string CommandLine(const std::string& arguments,
                        const std::string& program) {
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

Outcome RunShell(const std::string& command) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.Path() / "out";
  const std::filesystem::path err = folder.Path() / "err";
  const std::string redirected =
      command + " >" + Quote(out) + " 2>" + Quote(err) + " </dev/null";
  const int status = std::system(redirected.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(out),
          ReadFile(err)};
}

Outcome Succeed(Outcome outcome, const char* file, int line) {
  if (outcome.exit_code != 0) {
    ADD_FAILURE_AT(file, line) << "exit code " << outcome.exit_code << "\n"
                               << outcome.out << outcome.err;
  }
  return outcome;
}

void ExpectRefusal(const Outcome& outcome, const std::string& message) {
  EXPECT_EQ(outcome.exit_code, 1) << message;
  EXPECT_TRUE(HasAll(outcome.err, {"ERROR: ", message}));
  EXPECT_EQ(Count(outcome.err, "\n"), 1) << outcome.err;
}

void ExpectFullDisk(const std::string& command, uintmax_t max_file_size) {
  ExpectRefusal(RunShell("trap '' XFSZ; prlimit --fsize=" +
                         std::to_string(max_file_size) + " " + command),
                "File too large");
}

std::string BytesOf(const std::filesystem::path& mesh_path) {
  return ReadFile(mesh_path) + ReadFile(mesh_path.string() + ".vis");
}

void WriteMask(const std::filesystem::path& folder, const View& view,
               double share) {
  ColorImage mask{view.width, view.height, {}};
  for (int i = 0; i < view.width * view.height; ++i) {
    const uint8_t value = i < share * view.width * view.height ? 0 : 255;
    mask.pixels.push_back({value, value, value});
  }
  WriteFile(folder / (view.name + ".png"), EncodePng(mask));
}

void ExpectPageOfRun(const std::string& page, const Outcome& outcome) {
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

double NumberAfter(const std::string& key, const std::string& text) {
  const size_t at = text.find(key);
  if (at == std::string::npos) {
    ADD_FAILURE() << "no '" << key << "' in\n" << text;
    return std::nan("");
  }
  return std::stod(text.substr(at + key.size()));
}

Process::Process(const std::string& command_line,
                 const std::filesystem::path& err) {
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

Process::~Process() { close(output_); }

bool Process::WaitFor(const std::string& text) {
  std::string printed;
  while (printed.find(text) == std::string::npos) {
    if (!Read(&printed)) {
      return false;
    }
  }
  return true;
}

void Process::Signal(int number) const { kill(id_, number); }

int Process::Wait() {
  for (std::string rest; Read(&rest);) {
  }
  int status = 0;
  waitpid(id_, &status, 0);
  return status;
}

bool Process::Read(std::string* printed) const {
  char packet[PIPE_BUF];
  const ssize_t size = read(output_, packet, sizeof(packet));
  printed->append(packet, size > 0 ? static_cast<size_t>(size) : 0);
  return size > 0;
}

}  // namespace colmap_ext
