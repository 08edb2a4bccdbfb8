#pragma once

#include <string>

namespace colmap_ext {

// What a command line did.
struct Outcome {
  int exit_code = -1;  // 134 is an abort
  std::string out;
  std::string err;
};

Outcome RunShell(const std::string& command);

// Fails unless the command gave one line that says so, and exit code 1.
void ExpectRefusal(const Outcome& outcome, const std::string& message);

}  // namespace colmap_ext
