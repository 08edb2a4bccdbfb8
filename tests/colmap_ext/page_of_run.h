#pragma once

#include <cstddef>
#include <string>

#include "tests/colmap_ext/run_shell.h"

namespace colmap_ext {

// Fails unless the page is well-formed, needs nothing from elsewhere, and says
// all that the command has printed in its report.
void ExpectPageOfRun(const std::string& page, const Outcome& outcome);

size_t NumPictures(const std::string& page);

}  // namespace colmap_ext
