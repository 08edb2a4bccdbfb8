#include "colmap_ext/options/command_options.h"

#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "colmap_ext/terminal/terminal.h"

namespace colmap_ext {
namespace {

constexpr const char* kProjectPath = "project_path";

// Options of all commands of COLMAP 3.8 to 4.1. Our commands write no log and
// use no random numbers that depend on a seed.
constexpr std::array kCommonOptions = {
    "random_seed", "default_random_seed", "log_to_stderr", "log_target",
    "log_path",    "log_level",           "log_severity",  "log_color"};

// Other options that project_generator writes outside of any section.
constexpr std::array kProjectOptions = {"database_path", "image_path"};

bool IsAmong(const auto& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

// "Section" of "Section.name"; empty without one.
std::string SectionOf(const std::string& name) {
  const size_t dot = name.find('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

// The names of a command's options.
class Names {
 public:
  explicit Names(const CommandOptions& options) {
    for (const CommandOptions::Option& option : options.Options()) {
      names_[option.name] = option.name;
      if (option.is_list) {
        lists_.insert(option.name);
      }
      sections_[SectionOf(option.name)] = false;
    }
    for (const CommandOptions::Alias& alias : options.Aliases()) {
      names_[alias.name] = alias.option;
      sections_.emplace(SectionOf(alias.name), true);
    }
    names_[kProjectPath] = kProjectPath;
  }

  bool IsKnown(const std::string& name) const { return names_.contains(name); }

  bool IsList(const std::string& name) const {
    const auto it = names_.find(name);
    return it != names_.end() && lists_.contains(it->second);
  }

  bool IsOurSection(const std::string& section) const {
    return sections_.contains(section) && !sections_.at(section);
  }

  bool IsAliasSection(const std::string& section) const {
    return sections_.contains(section) && sections_.at(section);
  }

  // The name that starts like this, if there is one; else the text itself.
  // \throw OptionError if there are several, of different options.
  std::string Complete(const std::string& text) const {
    std::map<std::string, std::string> found;  // name by option
    for (auto it = names_.lower_bound(text);
         it != names_.end() && it->first.starts_with(text); ++it) {
      if (it->first == text) {
        return text;
      }
      found.emplace(it->second, it->first);
    }
    if (found.size() > 1) {
      throw OptionError(fmt::format("--{} is ambiguous: --{} or --{}", text,
                                    found.begin()->second,
                                    std::next(found.begin())->second));
    }
    return found.empty() ? text : found.begin()->second;
  }

 private:
  std::map<std::string, std::string> names_;  // the option of each name
  std::set<std::string> lists_;               // options
  std::map<std::string, bool> sections_;      // whether they are of aliases
};

// Options by the names that they are given by.
using Texts = std::map<std::string, std::string>;

// The values of a list, from argument i on; i becomes the last one.
std::string ReadList(int argc, const char* const* argv, int* i) {
  std::string list = argv[*i];
  while (*i + 1 < argc && argv[*i + 1][0] != '-') {
    list += kListSeparator;
    list += argv[++*i];
  }
  return list;
}

// `--name VALUE`, `--name=VALUE`, `-h`.
Texts ReadArguments(int argc, const char* const* argv, const Names& names,
                    ParsedOptions* parsed) {
  Texts texts;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "-h" || argument == "--help") {
      parsed->wants_help = true;
      continue;
    }
    if (argument == "--version") {
      parsed->wants_version = true;
      continue;
    }
    if (!argument.starts_with("--") || argument.size() == 2) {
      throw OptionError(fmt::format(
          "'{}' stands without an option; options are --name VALUE, and -h "
          "lists them",
          argument));
    }
    const size_t equals = argument.find('=');
    const std::string name = names.Complete(argument.substr(2, equals - 2));
    const bool is_last = i + 1 == argc;
    if (equals == std::string::npos &&
        (is_last || std::string_view(argv[i + 1]).starts_with("--"))) {
      throw OptionError(fmt::format("--{} needs a value", name));
    }
    const bool is_list = names.IsList(name);
    const std::string text = equals != std::string::npos
                                 ? argument.substr(equals + 1)
                             : is_list ? ReadList(argc, argv, &++i)
                                       : argv[++i];
    const auto [given, is_new] = texts.emplace(name, text);
    if (!is_new && is_list) {
      given->second += kListSeparator + text;
    } else if (!is_new) {
      throw OptionError(fmt::format("--{} is given twice", name));
    }
  }
  return texts;
}

std::string Trim(const std::string& text) {
  constexpr const char* kSpaces = " \t\r";
  const size_t begin = text.find_first_not_of(kSpaces);
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(kSpaces) - begin + 1);
}

Texts ReadProjectFile(const std::filesystem::path& path) {
  std::error_code error;
  std::ifstream file(path);
  if (!std::filesystem::is_regular_file(path, error) || !file) {
    throw OptionError(
        fmt::format("--project_path: {} cannot be read", path.string()));
  }
  Texts texts;
  std::string section;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line = Trim(line.substr(0, line.find('#')));
    if (line.empty()) {
      continue;
    }
    if (line.front() == '[' && line.back() == ']') {
      section = Trim(line.substr(1, line.size() - 2)) + ".";
      continue;
    }
    const size_t equals = line.find('=');
    const std::string name = Trim(line.substr(0, equals));
    if (equals == std::string::npos || name.empty()) {
      throw OptionError(
          fmt::format("{}, line {}: neither name=value nor [Section]",
                      path.string(), number));
    }
    if (!texts.emplace(section + name, Trim(line.substr(equals + 1))).second) {
      throw OptionError(fmt::format("{}, line {}: {} is given twice",
                                    path.string(), number, section + name));
    }
  }
  return texts;
}

// Removes the options without a meaning here from those given.
// \param is_file  they are of a project file, which is of other commands too.
void RemoveIgnored(const Names& names, bool is_file, Texts* texts,
                   ParsedOptions* parsed) {
  std::erase_if(*texts, [&](const auto& given) {
    const std::string& name = given.first;
    const std::string section = SectionOf(name);
    if (names.IsKnown(name) && !(is_file && name == kProjectPath)) {
      return false;
    }
    const bool is_other_section =
        is_file && !section.empty() && !names.IsOurSection(section);
    if (!names.IsAliasSection(section) && !is_other_section &&
        !IsAmong(kCommonOptions, name) &&
        !(is_file && IsAmong(kProjectOptions, name))) {
      throw OptionError(fmt::format("there is no option {}{}; -h lists them",
                                    is_file ? "" : "--", name));
    }
    const std::string what =
        is_other_section ? section + ".*" : (is_file ? "" : "--") + name;
    if (!IsAmong(parsed->ignored, what)) {
      parsed->ignored.push_back(what);
    }
    return true;
  });
}

// \param sources  the arguments, then a project file: the first that has an
//        option counts.
void Apply(const CommandOptions& options, const std::vector<Texts>& sources) {
  for (const CommandOptions::Option& option : options.Options()) {
    std::vector<CommandOptions::Alias> names = {{option.name, "", "", nullptr}};
    std::ranges::copy_if(
        options.Aliases(), std::back_inserter(names),
        [&](const auto& alias) { return alias.option == option.name; });
    for (const Texts& texts : sources) {
      const auto is_given = [&](const auto& alias) {
        return texts.contains(alias.name);
      };
      const auto given = std::ranges::find_if(names, is_given);
      if (given == names.end()) {
        continue;
      }
      const auto other = std::find_if(given + 1, names.end(), is_given);
      if (&texts == &sources[0] && other != names.end()) {
        throw OptionError(fmt::format("--{} and --{} are the same option",
                                      other->name, given->name));
      }
      const std::string& text = texts.at(given->name);
      if (!option.set(text)) {
        throw OptionError(fmt::format("--{} is '{}'; it has to be {}",
                                      given->name, text, option.kind));
      }
      if (given->is_used != nullptr) {
        *given->is_used = true;
      }
      break;
    }
  }
}

// Breaks a text at its spaces.
void PrintWrapped(const std::string& text, const std::string& indentation,
                  std::ostream& stream) {
  constexpr size_t kWidth = 80;
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
  PrintWrapped(help, "      ", stream);
}

void PrintGroup(const CommandOptions& options, OptionGroup group,
                const char* heading, std::ostream& stream) {
  for (const CommandOptions::Option& option : options.Options()) {
    if (option.group != group) {
      continue;
    }
    stream << std::exchange(heading, "");
    std::string value = option.default_value;
    if (option.range && value.find('.') != std::string::npos) {
      value = fmt::format("{:.4g}", std::stod(value));
    }
    const std::string range = option.range ? "; " + option.range->Text() : "";
    if (!value.empty()) {
      value = fmt::format(" (={}{})", value, range);
    }
    PrintOption("--" + option.name + value, option.help, stream);
  }
}

}  // namespace

ParsedOptions ParseOptions(int argc, const char* const* argv,
                           const CommandOptions& options) {
  const Names names(options);
  ParsedOptions parsed;
  std::vector<Texts> sources = {ReadArguments(argc, argv, names, &parsed)};
  if (parsed.wants_help || parsed.wants_version) {
    return parsed;
  }
  RemoveIgnored(names, false, &sources[0], &parsed);
  if (sources[0].contains(kProjectPath)) {
    sources.push_back(ReadProjectFile(sources[0].at(kProjectPath)));
    RemoveIgnored(names, true, &sources[1], &parsed);
  }
  Apply(options, sources);
  return parsed;
}

void PrintHelp(const CommandOptions& options, const std::string& versions,
               std::ostream& stream) {
  stream << versions << "\n\n" << options.Summary() << "\n\n";
  for (const std::string& example : options.Examples()) {
    stream << "  " << ProgramName() << " " << example << "\n";
  }
  stream << (options.Examples().empty() ? "" : "\n")
         << "Options are given as --name VALUE, or as lines name=VALUE of a "
            "project file;\nthe command line has priority.\n\n";
  PrintOption("-h, --help", "List the options", stream);
  PrintOption("--version", "Print the version", stream);
  PrintOption("--project_path", "Project file, as for COLMAP's commands",
              stream);
  PrintGroup(options, OptionGroup::kBasic, "", stream);
  PrintGroup(options, OptionGroup::kAdvanced, "\nAdvanced:\n\n", stream);
  PrintGroup(options, OptionGroup::kAblations, "\nAblations of the paper:\n\n",
             stream);
  const char* heading = "\nOther names:\n\n";
  for (const CommandOptions::Alias& alias : options.Aliases()) {
    stream << std::exchange(heading, "");
    PrintOption("--" + alias.name, "is --" + alias.option + alias.note, stream);
  }
}

}  // namespace colmap_ext
