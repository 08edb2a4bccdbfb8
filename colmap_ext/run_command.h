#pragma once

#include <functional>

#include "colmap_ext/colmap_compat.h"

namespace colmap_ext {

// What a user can do about errors that are not about his options or files.
struct CommandAdvice {
  const char* out_of_memory;  // how to need less
  const char* bug_files;      // to send with the report of a bug of ours
};

// Parses the options and runs a command: whatever it throws becomes one line on
// the screen.
// \param manager  has the command's options.
// \return the exit status: 128 + its number if a signal interrupted it.
int RunCommand(int argc, char** argv, colmap::OptionManager* manager,
               const std::function<void()>& command,
               const CommandAdvice& advice);

}  // namespace colmap_ext
