#include "colmap_ext/run_command.h"

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include "base/heap.h"
#include "colmap_ext/colmap_compat.h"

namespace colmap_ext {
namespace {

// COLMAP's logging takes SIGTERM for a crash and prints a stack trace.
void RestoreTermination() {
  struct sigaction action = {};
  sigaction(SIGTERM, nullptr, &action);
  if (action.sa_handler != SIG_IGN) {
    std::signal(SIGTERM, SIG_DFL);
  }
}

std::string HowTo(std::optional<Alternative> alternative,
                  const CommandAdvice& advice) {
  std::map<Alternative, const char*> all = {
      {Alternative::kSayImageOrder, "; give it by --image_order"},
      {Alternative::kOtherImageOrder, "; choose another --image_order"}};
  all.insert(advice.alternatives.begin(), advice.alternatives.end());
  const auto it = alternative ? all.find(*alternative) : all.end();
  return it != all.end() ? it->second : "";
}

// One line, whatever is quoted in it.
int Fail(std::string message) {
  std::ranges::replace_if(
      message, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  std::cout << std::flush;
  std::cerr << "ERROR: " << message << std::endl;
  return EXIT_FAILURE;
}

}  // namespace

int RunCommand(int argc, char** argv, const CommandOptions& command,
               const CommandAdvice& advice,
               const std::function<void(Console*)>& run) {
  try {
    const ParsedOptions parsed = ParseOptions(argc, argv, command);
    if (parsed.wants_help) {
      PrintHelp(command, Versions(), std::cout);
      return EXIT_SUCCESS;
    }
    if (parsed.wants_version) {
      std::cout << Versions() << std::endl;
      return EXIT_SUCCESS;
    }
    if (!parsed.ignored.empty()) {
      std::cout << fmt::format(
                       "NOTE: these options have no meaning here and are "
                       "ignored: {}",
                       fmt::join(parsed.ignored, ", "))
                << std::endl;
    }
    RestoreTermination();
    KeepFreedMemory();
    // The only place that limits the number of threads.
    std::optional<tbb::global_control> limit;
    if (command.NumThreads() > 0) {
      limit.emplace(tbb::global_control::max_allowed_parallelism,
                    command.NumThreads());
    }
    Console console;
    console.log.command = &command;
    run(&console);
    return EXIT_SUCCESS;
  } catch (const Interruption& interruption) {
    std::cout << std::flush;
    std::cerr << "Interrupted: " << interruption.what() << std::endl;
    return 128 + interruption.Signal();
  } catch (const FileError& error) {
    return Fail(error.what() + HowTo(error.GetAlternative(), advice));
  } catch (const std::bad_alloc&) {
    return Fail("out of memory; " + std::string(advice.out_of_memory));
  } catch (const std::invalid_argument& error) {
    return Fail(error.what());
  } catch (const std::logic_error& error) {
    // A mesh that failed the gate, or any other broken promise of our own code.
    return Fail(error.what() +
                std::string("; nothing was written. This is a bug of "
                            "colmap_ext, not of your data: please report it "
                            "with this message, the command line and, if you "
                            "can, ") +
                advice.bug_files);
  } catch (const std::filesystem::filesystem_error& error) {
    return Fail(error.path1().string() + ": " + error.code().message());
  } catch (const std::exception& error) {
    return Fail(error.what());
  }
}

}  // namespace colmap_ext
