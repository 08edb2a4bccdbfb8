#include "colmap_ext/run_command.h"

#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>

#include "formats/errors.h"

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

int Fail(const std::string& message) {
  std::cout << std::flush;
  std::cerr << "ERROR: " << message << std::endl;
  return EXIT_FAILURE;
}

}  // namespace

int RunCommand(int argc, char** argv, colmap::OptionManager* manager,
               const std::function<void()>& command,
               const CommandAdvice& advice) {
  try {
    if (!ParseOptions(argc, argv, manager)) {
      return EXIT_FAILURE;
    }
    RestoreTermination();
    command();
    return EXIT_SUCCESS;
  } catch (const Interruption& interruption) {
    std::cout << std::flush;
    std::cerr << "Interrupted: " << interruption.what() << std::endl;
    return 128 + interruption.Signal();
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
  } catch (const std::exception& error) {
    return Fail(error.what());
  }
}

}  // namespace colmap_ext
