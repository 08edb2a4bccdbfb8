#include "colmap_ext/options/read_project_file.h"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "colmap_ext/errors.h"

namespace colmap_ext {

namespace {

std::string Trim(const std::string& text) {
  constexpr const char* kSpaces = " \t\r";
  const size_t begin = text.find_first_not_of(kSpaces);
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(kSpaces) - begin + 1);
}

}  // namespace

std::map<std::string, std::string> ReadProjectFile(
    const std::filesystem::path& path) {
  std::error_code error;
  std::ifstream file(path);
  if (!std::filesystem::is_regular_file(path, error) || !file) {
    throw OptionError(
        fmt::format("--project_path: {} can not be read", path.string()));
  }
  std::map<std::string, std::string> options;
  std::string section;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line = Trim(line.substr(0, line.find('#')));
    if (line.empty()) {
      continue;
    }
    if (line.front() == '[' && line.back() == ']') {
      section = Trim(line.substr(1, line.size() - 2)) + ".";
      continue;
    }
    const size_t equals = line.find('=');
    const std::string name = Trim(line.substr(0, equals));
    if (equals == std::string::npos || name.empty()) {
      throw OptionError(
          fmt::format("{}, line {}: neither name=value nor [Section]",
                      path.string(), number));
    }
    if (!options.emplace(section + name, Trim(line.substr(equals + 1)))
             .second) {
      throw OptionError(fmt::format("{}, line {}: {} is there twice",
                                    path.string(), number, section + name));
    }
  }
  return options;
}

}  // namespace colmap_ext
