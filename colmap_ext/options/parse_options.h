#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_ext/options/command_options.h"

namespace colmap_ext {

// What a command line asks for besides values.
struct ParsedOptions {
  bool wants_help = false;
  // Options that are COLMAP's, or in a section of aliases, and mean nothing to
  // the command: as they were given, sections of a project file as "Name.*".
  std::vector<std::string> left_out;
};

// Sets the values of the options that the arguments give, and of those that the
// project file of --project_path gives besides: the arguments come first, and
// an option's own name before its alias. A name may be cut short where it stays
// the only one. Options of all of COLMAP's commands, such as --log_level, and
// the sections of other commands in a project file, as project_generator writes
// them, are left out.
//
// \param argc, argv  argv[0] is not an option.
// \throw OptionError if an option is unknown, given twice, without a value or
//        with one that it does not take, or the file can not be read. Values
//        may be set then.
ParsedOptions ParseOptions(int argc, const char* const* argv,
                           const CommandOptions& options);

}  // namespace colmap_ext
