#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace colmap_ext {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The finite numbers that an option takes.
struct NumberRange {
  double lower;
  double upper = kNoLimit;
  std::optional<double> also = std::nullopt;  // stands for something else

  bool Contains(double number) const;

  // "0 ... 1", "1 or more, or -1".
  std::string Text() const;
};

// Factors and the like. Beyond what is of use, and far from where their squares
// times a float overflow or vanish.
inline constexpr NumberRange kPositive{1e-6, 1e6};
inline constexpr NumberRange kNotNegative{0, 1e6};

inline constexpr NumberRange kLength{0, 1e9};        // scene units
inline constexpr NumberRange kGigabytes{1e-9, 1e6};  // GB, from a byte on

// A choice: for 2^31 threads TBB took a minute, and all memory.
inline constexpr NumberRange kThreads{1, 1024, -1};

// Where -1 stands for all, any or none, as the help says.
inline constexpr NumberRange kCountOrMinusOne{0, kNoLimit, -1};

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
    std::optional<NumberRange> range = std::nullopt;  // of numbers

    bool IsList() const {
      return std::holds_alternative<std::vector<std::string>*>(value);
    }

    // What the value has to be: "a whole number, 1 ... 8".
    std::string Kind() const;
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
  void AddDefaultOption(
      const std::string& name,
      std::variant<std::string*, bool*, std::vector<std::string>*> value,
      const std::string& help = "");

  // The same of a number. The range is checked and shown from here alone.
  void AddNumber(const std::string& name, std::variant<int*, double*> value,
                 const NumberRange& range, const std::string& help = "");

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

// Sets an option's value to what the text says.
// \return false if it says nothing of that type, or a number that is not in the
//         range; the value stays then.
bool SetValue(const std::string& text, const CommandOptions::Option& option);

}  // namespace colmap_ext
