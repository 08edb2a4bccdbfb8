#include "formats/read_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {

std::optional<std::vector<double>> ParseNumbers(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<double> numbers;
  for (;;) {
    text.remove_prefix(
        std::min(text.find_first_not_of(kSeparators), text.size()));
    if (text.empty()) {
      return numbers;
    }
    if (text.front() == '#') {
      text.remove_prefix(std::min(text.find('\n'), text.size()));
      continue;
    }
    if (text.front() == '+') {  // which from_chars does not take
      text.remove_prefix(1);
    }
    double number = 0;
    const auto [rest, error] =
        std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<size_t>(rest - text.data()));
    const bool is_whole =
        text.empty() || text.front() == '#' ||
        kSeparators.find(text.front()) != std::string_view::npos;
    if (error != std::errc() || !is_whole || !std::isfinite(number)) {
      return std::nullopt;
    }
    numbers.push_back(number);
  }
}

std::vector<double> ReadNumbers(const std::filesystem::path& path) {
  constexpr uint64_t kMaxSize = 1 << 16;  // bytes
  ByteReader reader(path);
  if (reader.Remaining() > kMaxSize) {
    throw FileError(path, "too long for a text of a few numbers");
  }
  std::string text(reader.Remaining(), ' ');
  reader.Read(text.data(), text.size(), "the text");
  std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers) {
    throw FileError(path, "not a text of numbers");
  }
  return *std::move(numbers);
}

}  // namespace colmap_ext
