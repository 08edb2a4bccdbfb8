#pragma once

#include <functional>
#include <map>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/report/print_report.h"
#include "formats/errors.h"

namespace colmap_ext {

// What a user can do about errors.
struct CommandAdvice {
  const char* out_of_memory;  // how to need less
  const char* bug_files;      // to send with the report of a bug of ours

  // The option for each alternative that a FileError offers, appended to its
  // message. All commands have --image_order. Without an entry nothing is
  // appended.
  std::map<Alternative, const char*> alternatives = {};
};

// Parses the options of a command and runs it: any exception becomes one line
// on the screen.
// \return the exit status: 128 + its number if a signal interrupted it.
int RunCommand(int argc, char** argv, const CommandOptions& command,
               const CommandAdvice& advice,
               const std::function<void(Console*)>& run);

// The same; finishes the options before.
// \param add  adds the command's options to its command line
template <typename Options>
int RunCommand(int argc, char** argv, void (*add)(CommandOptions*, Options*),
               void (*run)(const Options&, Console*),
               const CommandAdvice& advice) {
  Options options;
  CommandOptions command;
  add(&command, &options);
  return RunCommand(argc, argv, command, advice, [&](Console* console) {
    options.Finish();
    run(options, console);
  });
}

}  // namespace colmap_ext
