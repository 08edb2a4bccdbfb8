#pragma once

#include <string>
#include <variant>
#include <vector>

namespace colmap_ext {

// The options that a command takes, by the rules of COLMAP's command line: each
// has a value, `--name VALUE` or `--name=VALUE`, and so has a truth value. They
// are ours rather than COLMAP's OptionManager, whose help, messages and exits
// differ by version, and which takes either a project file or options.
class CommandOptions {
 public:
  // The last takes several values, `--name VALUE VALUE`, and may be given more
  // than once; a project file has one of them.
  using Value = std::variant<std::string*, bool*, int*, double*,
                             std::vector<std::string>*>;

  struct Option {
    std::string name;  // without dashes: "output_path", "Section.name"
    Value value;
    std::string default_value;  // as it is typed; may be empty
    std::string help;

    bool IsList() const {
      return std::holds_alternative<std::vector<std::string>*>(value);
    }
  };

  // Another name of an option.
  struct Alias {
    std::string name;
    std::string option;  // that it stands for
    std::string note;    // what differs by this name; may be empty
    bool* is_used;       // set if the value comes by this name; or nullptr
  };

  // Adds an option whose default is what the value is now.
  // \param value  has to outlive the parsing.
  // \param help  what it does; after its unit in brackets, if it has one:
  //        "[px] Side of a window".
  void AddDefaultOption(const std::string& name, Value value,
                        const std::string& help = "");

  // \param alias  "Section.name"; what is unknown in a section of aliases is
  //        left out, not refused.
  // \param is_used  has to outlive the parsing, or is nullptr.
  // \pre there is such an option
  void AddAlias(const std::string& alias, const std::string& option,
                const std::string& note = "", bool* is_used = nullptr);

  const std::vector<Option>& Options() const { return options_; }
  const std::vector<Alias>& Aliases() const { return aliases_; }

 private:
  std::vector<Option> options_;
  std::vector<Alias> aliases_;
};

// Between the values of a list in the text that SetValue() takes.
inline constexpr char kListSeparator = '\n';

// The text that a value is typed as.
std::string TextOf(const CommandOptions::Value& value);

// Sets a value to what the text says.
// \return false if it says nothing of that type; the value stays then.
bool SetValue(const std::string& text, const CommandOptions::Value& value);

}  // namespace colmap_ext
