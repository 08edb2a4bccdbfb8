#include "colmap_ext/report/print_lines.h"

#include <cstdio>
#include <ostream>

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
  char line[256];
  std::snprintf(line, sizeof(line), "  %-*s", kLabelWidth, label.c_str());
  stream << line << text << "\n";
}

void Print(const std::string& label, int64_t number, std::ostream& stream) {
  char text[32];
  std::snprintf(text, sizeof(text), "%*lld", kNumberWidth,
                static_cast<long long>(number));
  PrintText(label, text, stream);
}

void PrintIfAny(const std::string& label, size_t number, std::ostream& stream) {
  if (number > 0) {
    Print(label, static_cast<int64_t>(number), stream);
  }
}

std::string Format(const char* format, double a, double b) {
  char text[64];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

}  // namespace colmap_ext
