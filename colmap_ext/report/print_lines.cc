#include "colmap_ext/report/print_lines.h"

#include <ostream>

#include <fmt/format.h>

namespace colmap_ext {

namespace {

constexpr int kLabelWidth = 38;   // characters
constexpr int kNumberWidth = 14;  // characters

}  // namespace

void PrintHeading(const std::string& heading, ReportLog* log) {
  *log->stream << "\n" << heading << "\n";
  log->sections.push_back({heading, {}});
}

void PrintText(const std::string& label, const std::string& text,
               ReportLog* log) {
  *log->stream << fmt::format("  {:<{}}{}\n", label, kLabelWidth, text);
  if (log->sections.empty()) {
    log->sections.emplace_back();
  }
  log->sections.back().rows.push_back({label, text});
}

void Print(const std::string& label, int64_t number, ReportLog* log) {
  PrintText(label, fmt::format("{:{}}", number, kNumberWidth), log);
}

void PrintIfAny(const std::string& label, size_t number, ReportLog* log) {
  if (number > 0) {
    Print(label, static_cast<int64_t>(number), log);
  }
}

void PrintWarning(const std::string& what, ReportLog* log) {
  *log->stream << "WARNING: " << what << "\n";
  log->warnings.push_back(what);
}

}  // namespace colmap_ext
