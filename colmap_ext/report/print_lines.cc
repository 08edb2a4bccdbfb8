#include "colmap_ext/report/print_lines.h"

#include <ostream>

#include <fmt/format.h>

namespace colmap_ext {

namespace {

constexpr int kLabelWidth = 38;  // characters

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

void PrintNumber(const std::string& label, double number, ReportLog* log,
                 std::optional<int> decimals) {
  PrintText(label,
            decimals ? fmt::format("{:14.{}f}", number, *decimals)
                     : fmt::format("{:14.6g}", number),
            log);
}

void PrintWarning(const std::string& what, ReportLog* log) {
  *log->stream << "WARNING: " << what << "\n";
  log->warnings.push_back(what);
}

}  // namespace colmap_ext
