#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_ext {

// A program while it runs, which waits after each line that it prints until the
// line is read: its standard output is a pipe of packets with room for one.
class Process {
 public:
  // \param err  the file for its standard error.
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& err);
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
