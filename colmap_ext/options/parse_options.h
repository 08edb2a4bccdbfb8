#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "colmap_ext/options/command_options.h"

namespace colmap_ext {

// The result of parsing, besides the values.
struct ParsedOptions {
  bool wants_help = false;
  bool wants_version = false;
  // Ignored options: those of COLMAP, or of a section of aliases, that have no
  // meaning here. As they were given; sections of a project file as "Name.*".
  std::vector<std::string> ignored;
};

// Sets the values of the options that are given by the arguments, or by the
// project file of --project_path. Arguments have priority, and so has an
// option's own name over its aliases. Names can be abbreviated where they stay
// unique. Options of all COLMAP commands, such as --log_level, and sections of
// other commands in a project file are ignored.
//
// A project file is as COLMAP's project_generator writes it: lines
// `name=value`, in sections `[Section]` whose options are "Section.name"; `#`
// starts a comment. Spaces around names and values do not count.
//
// \param argc, argv  argv[0] is not an option.
// \throw OptionError if an option is unknown, given twice, without a value or
//        with an invalid one, or the file cannot be read. Some values may have
//        been set then.
ParsedOptions ParseOptions(int argc, const char* const* argv,
                           const CommandOptions& options);

// Prints a command's options by groups: each on a line of its own,
// `--name (=DEFAULT)` or `--name (=DEFAULT; RANGE)`, with its help below.
// docs/options.md is made from this.
// \param versions  of the programs, one line.
void PrintHelp(const CommandOptions& options, const std::string& versions,
               std::ostream& stream);

}  // namespace colmap_ext
