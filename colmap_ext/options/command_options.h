#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace colmap_ext {

// A command line that asks for something impossible. The message is one line
// for the user.
class OptionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// \throw OptionError if the condition holds
inline void RefuseIf(bool condition, const char* message) {
  if (condition) {
    throw OptionError(message);
  }
}

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The finite numbers that an option takes.
struct NumberRange {
  double lower;
  double upper = kNoLimit;
  std::optional<double> also = std::nullopt;  // a value with another meaning
  const char* word = nullptr;                 // that can be typed for `also`

  bool Contains(double number) const;

  // "0 ... 1", "1 or more, or -1", "0 ... 1, or auto".
  std::string Text() const;
};

// Factors and the like. Wider than useful, but squares of these numbers times a
// float neither overflow nor vanish.
inline constexpr NumberRange kPositive{1e-6, 1e6};
inline constexpr NumberRange kNotNegative{0, 1e6};

inline constexpr NumberRange kLength{0, 1e9};        // scene units
inline constexpr NumberRange kGigabytes{1e-9, 1e6};  // GB, from a byte on

// Chosen by hand: for 2^31 threads TBB took a minute, and all memory.
inline constexpr NumberRange kThreads{1, 1024, -1};

// -1 stands for all, any or none, as the help says.
inline constexpr NumberRange kCountOrMinusOne{0, kNoLimit, -1};

// Groups of options in the help, in this order.
enum class OptionGroup { kBasic, kAdvanced, kAblations };

// The options of a command, by the rules of COLMAP's command line: each has a
// value, `--name VALUE` or `--name=VALUE`; truth values are 0 or 1. COLMAP's
// OptionManager is not used: its help, messages and exits differ by version,
// and it takes either a project file or options.
class CommandOptions {
 public:
  using Value = std::variant<std::string*, std::filesystem::path*, bool*,
                             std::vector<std::string>*>;

  struct Option {
    std::string name;  // without dashes: "output_path", "Section.name"
    std::string help;
    OptionGroup group;
    std::string kind;  // of the value: "a whole number, 1 ... 8"
    std::function<std::string()> text;  // the value, as typed
    // Sets the value. Returns false, and keeps the value, if the text is not of
    // this kind.
    std::function<bool(const std::string&)> set;
    std::optional<NumberRange> range = std::nullopt;  // of numbers
    bool is_list = false;  // takes several values, see Add()
    std::string default_value = text();
  };

  // Another name of an option.
  struct Alias {
    std::string name;
    std::string option;  // the option's own name
    std::string note;    // how the meaning differs; may be empty
    bool* is_used;       // set if the value is given by this name; or nullptr
  };

  // \param summary  what the command does
  // \param examples  of calls, without the program
  void SetSummary(std::string summary, std::vector<std::string> examples = {}) {
    summary_ = std::move(summary);
    examples_ = std::move(examples);
  }

  // Options are added to this group from now on.
  void SetGroup(OptionGroup group) { group_ = group; }

  // Adds an option; its default is the current value. A list takes several
  // values, `--name VALUE VALUE`, and can be given more than once; in a project
  // file it has one value.
  // \param value  has to outlive the parsing, as in all of these.
  // \param help  its effect, after its unit in brackets, if it has one: "[px]
  //        Side of a window".
  void Add(const std::string& name, Value value, const std::string& help = "");

  // Adds a number.
  void Add(const std::string& name, std::variant<int*, double*> value,
           const NumberRange& range, const std::string& help = "");

  // Adds a choice of words; upper and lower case are the same.
  // \param words  each with the value that it stands for
  template <typename Value>
  void AddWord(const std::string& name, Value* value,
               std::vector<std::pair<const char*, Value>> words,
               const std::string& help) {
    std::vector<std::string> names(words.size());
    std::ranges::transform(words, names.begin(),
                           [](const auto& word) { return word.first; });
    const auto find = [=] {
      return static_cast<size_t>(
          std::ranges::find(words, *value,
                            &std::pair<const char*, Value>::second) -
          words.begin());
    };
    AddChoice(
        name, names, find, [=](size_t i) { *value = words[i].second; }, help);
  }

  // Adds a choice of words that set the values of options added later, unless
  // these are given, too.
  // \param words  each with what sets the values
  // \param chosen  index of the word whose values the options have already
  void AddPreset(
      const std::string& name,
      const std::vector<std::pair<const char*, std::function<void()>>>& words,
      size_t chosen, const std::string& help);

  // Adds another name of an option. What is unknown in a section that has only
  // aliases is ignored, not refused.
  // \param is_used  has to outlive the parsing, or is nullptr.
  // \pre there is such an option
  void AddAlias(const std::string& alias, const std::string& option,
                const std::string& note = "", bool* is_used = nullptr) {
    aliases_.push_back({alias, option, note, is_used});
  }

  // Adds "num_threads", and its alias SECTION.num_threads; without a section,
  // no alias.
  void AddThreads(const std::string& section = "");

  // To be used at most; -1 for all.
  int NumThreads() const { return *num_threads_; }

  const std::string& Summary() const { return summary_; }
  const std::vector<std::string>& Examples() const { return examples_; }
  const std::vector<Option>& Options() const { return options_; }
  const std::vector<Alias>& Aliases() const { return aliases_; }

 private:
  void AddChoice(const std::string& name, const std::vector<std::string>& words,
                 const std::function<size_t()>& get,
                 const std::function<void(size_t)>& set,
                 const std::string& help);

  std::string summary_;
  std::vector<std::string> examples_;
  OptionGroup group_ = OptionGroup::kBasic;
  std::vector<Option> options_;
  std::vector<Alias> aliases_;
  std::unique_ptr<int> num_threads_ = std::make_unique<int>(-1);
};

// Separates the values of a list in the text that Option::set takes.
inline constexpr char kListSeparator = '\n';

// The finite numbers in a text, "1,2,3".
// \param option  its name, for the message.
// \param count   the number of numbers; 0: one or more
// \throw OptionError if the text is anything else.
std::vector<double> ParseNumberList(const std::string& option,
                                    const std::string& text, size_t count);

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
