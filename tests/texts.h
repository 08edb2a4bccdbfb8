#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace colmap_ext {

// Whether a text has a part, with both in the message.
inline testing::AssertionResult Has(std::string_view text,
                                    std::string_view part) {
  const bool has = text.find(part) != std::string_view::npos;
  return (has ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "'" << part << (has ? "' is" : "' is not") << " in:\n"
         << text;
}

// The same for all of several parts.
inline testing::AssertionResult HasAll(
    std::string_view text, std::initializer_list<std::string_view> parts) {
  for (const std::string_view part : parts) {
    if (const testing::AssertionResult has = Has(text, part); !has) {
      return has;
    }
  }
  return testing::AssertionSuccess();
}

// Whether a text has none of several parts.
inline testing::AssertionResult HasNone(
    std::string_view text, std::initializer_list<std::string_view> parts) {
  for (const std::string_view part : parts) {
    if (const testing::AssertionResult has = Has(text, part); has) {
      return !has;
    }
  }
  return testing::AssertionSuccess();
}

// How often a text has a part.
inline size_t Count(std::string_view text, std::string_view part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string_view::npos;
       at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

// The message of the exception of this type that the function throws; a failure
// if it throws none.
template <typename Error, typename Function>
std::string MessageOf(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

}  // namespace colmap_ext
