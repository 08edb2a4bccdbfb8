#include "colmap_ext/options/parse_options.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/read_project_file.h"

namespace colmap_ext {

namespace {

constexpr const char* kProjectPath = "project_path";

// Of all commands of COLMAP 3.8 to 4.1. Ours keep no log and draw no numbers
// that a seed could change.
constexpr std::array kCommonOptions = {
    "random_seed", "default_random_seed", "log_to_stderr", "log_target",
    "log_path",    "log_level",           "log_severity",  "log_color"};

// What project_generator writes outside of any section besides.
constexpr std::array kProjectOptions = {"database_path", "image_path"};

bool IsAmong(const auto& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// "Section" of "Section.name"; empty without one.
std::string SectionOf(const std::string& name) {
  const size_t dot = name.find('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

// The names of a command's options, and what they stand for.
class Names {
 public:
  explicit Names(const CommandOptions& options) {
    for (const CommandOptions::Option& option : options.Options()) {
      options_[option.name] = &option;
      sections_[SectionOf(option.name)] = false;
    }
    for (const CommandOptions::Alias& alias : options.Aliases()) {
      aliases_[alias.name] = &alias;
      sections_.emplace(SectionOf(alias.name), true);
    }
  }

  const CommandOptions::Option* FindOption(const std::string& name) const {
    const auto it = options_.find(name);
    return it != options_.end() ? it->second : nullptr;
  }

  const CommandOptions::Alias* FindAlias(const std::string& name) const {
    const auto it = aliases_.find(name);
    return it != aliases_.end() ? it->second : nullptr;
  }

  bool IsOurSection(const std::string& section) const {
    return sections_.contains(section) && !sections_.at(section);
  }

  bool IsAliasSection(const std::string& section) const {
    return sections_.contains(section) && sections_.at(section);
  }

  // The only name that starts like this; else the text itself.
  // \throw OptionError if there are several.
  std::string Complete(const std::string& text) const {
    std::vector<std::string> found;
    const auto add = [&](const std::string& name) {
      if (name == text) {
        found = {name};
        return true;
      }
      if (name.starts_with(text)) {
        found.push_back(name);
      }
      return false;
    };
    for (const auto& [name, option] : options_) {
      if (add(name)) return name;
    }
    for (const auto& [name, alias] : aliases_) {
      if (add(name)) return name;
    }
    for (const char* name : {"help", kProjectPath}) {
      if (add(name)) return name;
    }
    if (found.size() > 1) {
      throw OptionError(fmt::format("--{} is ambiguous: --{} or --{}", text,
                                    found[0], found[1]));
    }
    return found.empty() ? text : found[0];
  }

 private:
  std::map<std::string, const CommandOptions::Option*> options_;
  std::map<std::string, const CommandOptions::Alias*> aliases_;
  std::map<std::string, bool> sections_;  // whether they are of aliases
};

// Options by the names that they are given by.
using Texts = std::map<std::string, std::string>;

// The values of a list, from argument i on, which is left at the last one.
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
    const CommandOptions::Option* const option = names.FindOption(name);
    const bool is_list = option != nullptr && option->IsList();
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

// Takes the options that mean nothing here out of those given.
// \param is_file  they are of a project file, which is of other commands too.
void LeaveOut(const Names& names, bool is_file, Texts* texts,
              ParsedOptions* parsed) {
  for (auto it = texts->begin(); it != texts->end();) {
    const std::string& name = it->first;
    const std::string section = SectionOf(name);
    const bool is_known = names.FindOption(name) != nullptr ||
                          names.FindAlias(name) != nullptr ||
                          (!is_file && name == kProjectPath);
    const bool is_other_section =
        is_file && !section.empty() && !names.IsOurSection(section);
    const bool means_nothing =
        !is_known && (names.IsAliasSection(section) || is_other_section ||
                      IsAmong(kCommonOptions, name) ||
                      (is_file && IsAmong(kProjectOptions, name)));
    if (!is_known && !means_nothing) {
      throw OptionError(fmt::format("there is no option {}{}; -h lists them",
                                    is_file ? "" : "--", name));
    }
    if (means_nothing) {
      const std::string what =
          is_other_section ? section + ".*" : (is_file ? "" : "--") + name;
      if (!IsAmong(parsed->left_out, what)) {
        parsed->left_out.push_back(what);
      }
    }
    it = means_nothing ? texts->erase(it) : std::next(it);
  }
}

// Sets a value by its text.
void Apply(const CommandOptions::Option& option, const std::string& name,
           const std::string& text) {
  if (!SetValue(text, option)) {
    throw OptionError(fmt::format("--{} is '{}'; it has to be {}", name, text,
                                  option.Kind()));
  }
}

// \param sources  what comes first counts.
void Apply(const CommandOptions& options, const std::vector<Texts>& sources) {
  for (const CommandOptions::Option& option : options.Options()) {
    for (const Texts& texts : sources) {
      if (const auto it = texts.find(option.name); it != texts.end()) {
        Apply(option, option.name, it->second);
        break;
      }
      const auto alias =
          std::find_if(options.Aliases().begin(), options.Aliases().end(),
                       [&](const CommandOptions::Alias& candidate) {
                         return candidate.option == option.name &&
                                texts.contains(candidate.name);
                       });
      if (alias != options.Aliases().end()) {
        Apply(option, alias->name, texts.at(alias->name));
        if (alias->is_used != nullptr) {
          *alias->is_used = true;
        }
        break;
      }
    }
  }
}

void ExpectOneName(const CommandOptions& options, const Texts& arguments) {
  for (const CommandOptions::Alias& alias : options.Aliases()) {
    if (arguments.contains(alias.name) && arguments.contains(alias.option)) {
      throw OptionError(fmt::format("--{} and --{} are the same option",
                                    alias.name, alias.option));
    }
  }
}

}  // namespace

ParsedOptions ParseOptions(int argc, const char* const* argv,
                           const CommandOptions& options) {
  const Names names(options);
  ParsedOptions parsed;
  std::vector<Texts> sources = {ReadArguments(argc, argv, names, &parsed)};
  if (parsed.wants_help) {
    return parsed;
  }
  LeaveOut(names, false, &sources[0], &parsed);
  ExpectOneName(options, sources[0]);
  if (sources[0].contains(kProjectPath)) {
    sources.push_back(ReadProjectFile(sources[0].at(kProjectPath)));
    LeaveOut(names, true, &sources[1], &parsed);
  }
  Apply(options, sources);
  return parsed;
}

}  // namespace colmap_ext
