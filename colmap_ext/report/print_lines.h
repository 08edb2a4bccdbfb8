#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace colmap_ext {

// One fact. The text's columns of numbers are aligned by blanks.
struct ReportRow {
  std::string label;
  std::string text;
};

struct ReportSection {
  std::string heading;
  std::vector<ReportRow> rows;
};

// A report: printed as it grows, and kept for a page, so that both say the
// same.
struct ReportLog {
  // \param printed  where it is printed; outlives the log.
  explicit ReportLog(std::ostream* printed) : stream(printed) {}

  std::ostream* stream;
  std::vector<ReportSection> sections;
  std::vector<std::string> warnings;
};

// The lines of a report on the screen: one fact a line, numbers in one column.

void PrintHeading(const std::string& heading, ReportLog* log);

void PrintText(const std::string& label, const std::string& text,
               ReportLog* log);

void Print(const std::string& label, int64_t number, ReportLog* log);

void PrintIfAny(const std::string& label, size_t number, ReportLog* log);

void PrintWarning(const std::string& what, ReportLog* log);

}  // namespace colmap_ext
