#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

namespace colmap_ext {

// The lines of a report on the screen: one fact a line, numbers in one column.

void PrintHeading(const char* heading, std::ostream& stream);

void PrintText(const std::string& label, const std::string& text,
               std::ostream& stream);

void Print(const std::string& label, int64_t number, std::ostream& stream);

void PrintIfAny(const std::string& label, size_t number, std::ostream& stream);

}  // namespace colmap_ext
