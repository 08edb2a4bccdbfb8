#include "tests/colmap_ext/run_shell.h"

#include <stdlib.h>
#include <sys/wait.h>

#include <algorithm>

#include "tests/formats/test_files.h"

namespace colmap_ext {

Outcome RunShell(const std::string& command) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.Path() / "out";
  const std::filesystem::path err = folder.Path() / "err";
  const std::string redirected = command + " >\"" + out.string() + "\" 2>\"" +
                                 err.string() + "\" </dev/null";
  const int status = std::system(redirected.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(out),
          ReadFile(err)};
}

void ExpectRefusal(const Outcome& outcome, const std::string& message) {
  EXPECT_EQ(outcome.exit_code, 1) << message;
  EXPECT_NE(outcome.err.find("ERROR: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(message), std::string::npos)
      << "expected: " << message << "\nfound: " << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1)
      << outcome.err;
}

}  // namespace colmap_ext
