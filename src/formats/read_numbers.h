#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace colmap_ext {

// The finite numbers of a text, between blanks, line ends or commas; what
// follows a `#` in its line is a comment.
// \return nothing if there is anything else in it
std::optional<std::vector<double>> ParseNumbers(std::string_view text);

// The same of a file of a few numbers.
// \throw FileError if it is missing, has anything else in it, or is longer than
//        64 KB.
std::vector<double> ReadNumbers(const std::filesystem::path& path);

}  // namespace colmap_ext
