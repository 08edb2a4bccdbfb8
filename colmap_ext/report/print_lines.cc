#include "colmap_ext/report/print_lines.h"

#include <ostream>

#include <fmt/format.h>

namespace colmap_ext {

namespace {

constexpr int kLabelWidth = 38;   // characters
constexpr int kNumberWidth = 14;  // characters

}  // namespace

void PrintHeading(const char* heading, std::ostream& stream) {
  stream << "\n" << heading << "\n";
}

void PrintText(const std::string& label, const std::string& text,
               std::ostream& stream) {
  stream << fmt::format("  {:<{}}{}\n", label, kLabelWidth, text);
}

void Print(const std::string& label, int64_t number, std::ostream& stream) {
  PrintText(label, fmt::format("{:{}}", number, kNumberWidth), stream);
}

void PrintIfAny(const std::string& label, size_t number, std::ostream& stream) {
  if (number > 0) {
    Print(label, static_cast<int64_t>(number), stream);
  }
}

}  // namespace colmap_ext
