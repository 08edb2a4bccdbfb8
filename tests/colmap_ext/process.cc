#include "tests/colmap_ext/process.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace colmap_ext {

Process::Process(const std::string& program,
                 const std::vector<std::string>& arguments,
                 const std::filesystem::path& err) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) {
    argv.push_back(const_cast<char*>(argument.c_str()));
  }
  argv.push_back(nullptr);
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
    execv(argv[0], argv.data());
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
