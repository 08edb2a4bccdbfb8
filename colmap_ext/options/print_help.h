#pragma once

#include <ostream>
#include <string>

#include "colmap_ext/options/command_options.h"

namespace colmap_ext {

// Prints a command's options: each on a line of its own, `--name (=DEFAULT)` or
// `--name (=DEFAULT; RANGE)`, with its help below. docs/scripts.md is made from
// this.
// \param versions  of the programs, one line.
void PrintHelp(const CommandOptions& options, const std::string& versions,
               std::ostream& stream);

}  // namespace colmap_ext
