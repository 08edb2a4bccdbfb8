#include "colmap_ext/options/print_help.h"

#include <sstream>

namespace colmap_ext {

namespace {

// Breaks a text at its spaces.
void PrintWrapped(const std::string& text, std::ostream& stream) {
  constexpr size_t kWidth = 80;
  const std::string indentation = "      ";
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) {
    if (!line.empty() &&
        indentation.size() + line.size() + 1 + word.size() > kWidth) {
      stream << indentation << line << "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  if (!line.empty()) {
    stream << indentation << line << "\n";
  }
}

void PrintOption(const std::string& name, const std::string& help,
                 std::ostream& stream) {
  stream << "  " << name << "\n";
  PrintWrapped(help, stream);
}

}  // namespace

void PrintHelp(const CommandOptions& options, const std::string& versions,
               std::ostream& stream) {
  stream << versions
         << "\n\nOptions are given by --name VALUE, or by lines name=VALUE of "
            "a project file;\nthe command line comes first.\n\n";
  PrintOption("-h, --help", "List the options", stream);
  PrintOption("--project_path", "The project file, as COLMAP's commands have",
              stream);
  for (const CommandOptions::Option& option : options.Options()) {
    const std::string range = option.range ? "; " + option.range->Text() : "";
    const std::string given = option.default_value.empty()
                                  ? ""
                                  : " (=" + option.default_value + range + ")";
    PrintOption("--" + option.name + given, option.help, stream);
  }
  if (!options.Aliases().empty()) {
    stream << "\nOther names:\n\n";
  }
  for (const CommandOptions::Alias& alias : options.Aliases()) {
    PrintOption("--" + alias.name, "is --" + alias.option + alias.note, stream);
  }
}

}  // namespace colmap_ext
