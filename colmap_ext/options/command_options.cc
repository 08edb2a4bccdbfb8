#include "colmap_ext/options/command_options.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>

#include <fmt/format.h>

#include "formats/read_numbers.h"

namespace colmap_ext {
namespace {

std::string ToLower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return text;
}

template <typename Text>  // or path
bool Parse(const std::string& text, Text* value) {
  *value = text;
  return true;
}

bool Parse(const std::string& text, std::vector<std::string>* value) {
  value->clear();
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, kListSeparator);) {
    value->push_back(item);
  }
  return true;
}

bool Parse(const std::string& text, bool* value) {
  constexpr std::array kTrue = {"1", "true", "yes", "on"};
  constexpr std::array kFalse = {"0", "false", "no", "off"};
  const bool is_true = std::ranges::count(kTrue, ToLower(text)) > 0;
  const bool is_known =
      is_true || std::ranges::count(kFalse, ToLower(text)) > 0;
  *value = is_known ? is_true : *value;
  return is_known;
}

template <typename Number>
bool ParseNumber(const std::string& text, const NumberRange& range,
                 Number* value) {
  if (range.word != nullptr && text == range.word) {
    *value = static_cast<Number>(*range.also);
    return true;
  }
  const char* const begin = text.data() + text.starts_with('+');
  const char* const end = text.data() + text.size();
  Number number{};
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || rest != end || !range.Contains(number)) {
    return false;
  }
  *value = number;
  return true;
}

std::string TextOf(const std::string& value) { return value; }  // or path
std::string TextOf(bool value) { return value ? "1" : "0"; }
std::string TextOf(const std::vector<std::string>& value) {
  return fmt::format("{}", fmt::join(value, ","));
}

}  // namespace

bool NumberRange::Contains(double number) const {
  return std::isfinite(number) &&
         ((number >= lower && number <= upper) || number == also);
}

std::string NumberRange::Text() const {
  const std::string numbers = std::isfinite(upper)
                                  ? fmt::format("{} ... {}", lower, upper)
                                  : fmt::format("{} or more", lower);
  return numbers + (word != nullptr ? fmt::format(", or {}", word)
                    : also          ? fmt::format(", or {}", *also)
                                    : "");
}

void CommandOptions::Add(const std::string& name, Value value,
                         const std::string& help) {
  constexpr const char* kKinds[] = {"a text", "a path", "0 or 1", "a list"};
  std::visit(
      [&](auto* pointer) {
        options_.push_back(
            {.name = name,
             .help = help,
             .group = group_,
             .kind = kKinds[value.index()],
             .text = [=] { return TextOf(*pointer); },
             .set = [=](const std::string& s) { return Parse(s, pointer); },
             .is_list = value.index() == 3});
      },
      value);
}

void CommandOptions::Add(const std::string& name,
                         std::variant<int*, double*> value,
                         const NumberRange& range, const std::string& help) {
  constexpr const char* kKinds[] = {"a whole number, ", "a number, "};
  std::visit(
      [&](auto* pointer) {
        const auto text = [=] {
          return range.word != nullptr && *pointer == range.also
                     ? range.word
                     : fmt::format("{}", *pointer);
        };
        const auto set = [=](const std::string& typed) {
          return ParseNumber(typed, range, pointer);
        };
        options_.push_back({name, help, group_,
                            kKinds[value.index()] + range.Text(), text, set,
                            range});
      },
      value);
}

void CommandOptions::AddChoice(const std::string& name,
                               const std::vector<std::string>& words,
                               const std::function<size_t()>& get,
                               const std::function<void(size_t)>& set,
                               const std::string& help) {
  const std::string list = fmt::format("{{{}}}: ", fmt::join(words, ", "));
  const auto all_but_last = std::span(words).first(words.size() - 1);
  options_.push_back(
      {.name = name,
       .help = list + help,
       .group = group_,
       .kind =
           fmt::format("{} or {}", fmt::join(all_but_last, ", "), words.back()),
       .text = [=] { return words[get()]; },
       .set =
           [=](const std::string& text) {
             const auto it = std::ranges::find(words, ToLower(text));
             if (it != words.end()) {
               set(static_cast<size_t>(it - words.begin()));
             }
             return it != words.end();
           }});
}

void CommandOptions::AddPreset(
    const std::string& name,
    const std::vector<std::pair<const char*, std::function<void()>>>& words,
    size_t chosen, const std::string& help) {
  std::vector<std::string> names(words.size());
  std::ranges::transform(words, names.begin(),
                         [](const auto& word) { return word.first; });
  const auto index = std::make_shared<size_t>(chosen);
  AddChoice(
      name, names, [index] { return *index; },
      [index, words](size_t i) {
        *index = i;
        words[i].second();
      },
      help);
}

std::vector<double> ParseNumberList(const std::string& option,
                                    const std::string& text, size_t count) {
  std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers || numbers->empty() || (count > 0 && numbers->size() != count)) {
    throw OptionError(fmt::format(
        "{} is '{}'; it has to be {}numbers separated by commas, all finite",
        option, text, count > 0 ? fmt::format("{} ", count) : ""));
  }
  return *std::move(numbers);
}

void CommandOptions::AddThreads(const std::string& section) {
  Add("num_threads", num_threads_.get(), kThreads,
      "[threads] Number of threads; -1: all cores. The result does not "
      "depend on it");
  if (!section.empty()) {
    AddAlias(section + ".num_threads", "num_threads");
  }
}

}  // namespace colmap_ext
