#include "colmap_ext/options/command_options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <type_traits>

#include <fmt/format.h>

namespace colmap_ext {

namespace {

std::string ToLower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool Parse(const std::string& text, const NumberRange&, std::string* value) {
  *value = text;
  return true;
}

bool Parse(const std::string& text, const NumberRange&,
           std::vector<std::string>* value) {
  value->clear();
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, kListSeparator);) {
    value->push_back(item);
  }
  return true;
}

bool Parse(const std::string& text, const NumberRange&, bool* value) {
  const std::string word = ToLower(text);
  for (const char* name : {"1", "true", "yes", "on"}) {
    if (word == name) {
      *value = true;
      return true;
    }
  }
  for (const char* name : {"0", "false", "no", "off"}) {
    if (word == name) {
      *value = false;
      return true;
    }
  }
  return false;
}

template <typename Number>
bool Parse(const std::string& text, const NumberRange& range, Number* value) {
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

}  // namespace

bool NumberRange::Contains(double number) const {
  return std::isfinite(number) &&
         ((number >= lower && number <= upper) || number == also);
}

std::string NumberRange::Text() const {
  return (std::isfinite(upper) ? fmt::format("{} ... {}", lower, upper)
                               : fmt::format("{} or more", lower)) +
         (also ? fmt::format(", or {}", *also) : "");
}

std::string CommandOptions::Option::Kind() const {
  constexpr const char* kKinds[] = {"a text", "0 or 1", "a whole number",
                                    "a number", "a list"};
  return kKinds[value.index()] + (range ? ", " + range->Text() : "");
}

void CommandOptions::AddDefaultOption(
    const std::string& name,
    std::variant<std::string*, bool*, std::vector<std::string>*> value,
    const std::string& help) {
  std::visit(
      [&](auto* pointer) {
        options_.push_back({name, pointer, TextOf(pointer), help});
      },
      value);
}

void CommandOptions::AddNumber(const std::string& name,
                               std::variant<int*, double*> value,
                               const NumberRange& range,
                               const std::string& help) {
  std::visit(
      [&](auto* pointer) {
        options_.push_back({name, pointer, TextOf(pointer), help, range});
      },
      value);
}

void CommandOptions::AddAlias(const std::string& alias,
                              const std::string& option,
                              const std::string& note, bool* is_used) {
  aliases_.push_back({alias, option, note, is_used});
}

std::string TextOf(const CommandOptions::Value& value) {
  return std::visit(
      [](const auto* pointer) {
        using T = std::remove_cvref_t<decltype(*pointer)>;
        if constexpr (std::is_same_v<T, bool>) {
          return fmt::format("{:d}", *pointer);
        } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
          return fmt::format("{}", fmt::join(*pointer, ","));
        } else {
          return fmt::format("{}", *pointer);
        }
      },
      value);
}

bool SetValue(const std::string& text, const CommandOptions::Option& option) {
  const NumberRange range = option.range.value_or(NumberRange{0});
  return std::visit([&](auto* pointer) { return Parse(text, range, pointer); },
                    option.value);
}

}  // namespace colmap_ext
