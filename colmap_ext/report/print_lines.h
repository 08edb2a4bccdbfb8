#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace colmap_ext {

// One fact. Columns of numbers in the text are aligned by blanks.
struct ReportRow {
  std::string label;
  std::string text;
};

struct ReportSection {
  std::string heading;
  std::vector<ReportRow> rows;
};

// A report: printed as it grows, and kept for the page.
struct ReportLog {
  // \param printed  the stream to print to; outlives the log.
  explicit ReportLog(std::ostream* printed) : stream(printed) {}

  std::ostream* stream;
  std::vector<ReportSection> sections;
  std::vector<std::string> warnings;
};

// Print the lines of a report: one fact a line, numbers in one column.

void PrintHeading(const std::string& heading, ReportLog* log);

void PrintText(const std::string& label, const std::string& text,
               ReportLog* log);

// \param decimals  digits after the point; nullopt: six significant digits.
void PrintNumber(const std::string& label, double number, ReportLog* log,
                 std::optional<int> decimals = std::nullopt);

void Print(const std::string& label, std::integral auto number,
           ReportLog* log) {
  constexpr size_t kNumberWidth = 14;  // characters
  const std::string digits = std::to_string(number);
  PrintText(
      label,
      std::string(kNumberWidth - std::min(kNumberWidth, digits.size()), ' ') +
          digits,
      log);
}

void PrintIfAny(const std::string& label, std::integral auto number,
                ReportLog* log) {
  if (number > 0) {
    Print(label, number, log);
  }
}

void PrintWarning(const std::string& what, ReportLog* log);

}  // namespace colmap_ext
