#pragma once

#include <functional>
#include <map>

#include "colmap_ext/options/command_options.h"
#include "formats/errors.h"

namespace colmap_ext {

// What a user can do about errors.
struct CommandAdvice {
  const char* out_of_memory;  // how to need less
  const char* bug_files;      // to send with the report of a bug of ours

  // The option for each alternative that a FileError offers, appended to its
  // message. Without an entry nothing is appended.
  std::map<Alternative, const char*> alternatives;
};

// What a command does after its options are known.
struct CommandSteps {
  std::function<void()> finish_options;  // after they are parsed
  const int* num_threads;                // to be used at most, then; -1 for all
  std::function<void()> run;
};

// Parses the options and runs a command: any exception becomes one line on
// the screen.
// \return the exit status: 128 + its number if a signal interrupted it.
int RunCommand(int argc, char** argv, const CommandOptions& options,
               const CommandSteps& steps, const CommandAdvice& advice);

// Has memory of that size and above returned to the system when it is freed.
// Without this, glibc puts blocks of up to 32 MB between others on the heap,
// where they leave holes. Does nothing with other libraries.
void ReturnBlocksFrom(int num_bytes);

}  // namespace colmap_ext
