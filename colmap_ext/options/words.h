#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "colmap_ext/errors.h"

namespace colmap_ext {

// The value that a word of the command line stands for.
// \param option  its name, for the message.
// \param words  the words that there are; two or more.
// \throw OptionError if the word is none of them.
template <typename Value>
Value ParseWord(const char* option, const std::string& word,
                std::initializer_list<std::pair<const char*, Value>> words) {
  std::string list;
  for (const auto& [name, value] : words) {
    if (word == name) {
      return value;
    }
    const bool is_last = name == (words.end() - 1)->first;
    list += fmt::format("{}{}",
                        list.empty() ? ""
                        : is_last    ? " or "
                                     : ", ",
                        name);
  }
  throw OptionError(
      fmt::format("{} is '{}'; it has to be {}", option, word, list));
}

}  // namespace colmap_ext
