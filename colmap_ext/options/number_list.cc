#include "colmap_ext/options/number_list.h"

#include <optional>

#include <fmt/format.h>

#include "colmap_ext/errors.h"
#include "formats/read_numbers.h"

namespace colmap_ext {

std::vector<double> ParseNumberList(const std::string& option,
                                    const std::string& text, size_t count) {
  std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers || numbers->empty() || (count > 0 && numbers->size() != count)) {
    throw OptionError(fmt::format(
        "{} is '{}'; it has to be {}numbers separated by commas, all finite",
        option, text, count > 0 ? fmt::format("{} ", count) : ""));
  }
  return *std::move(numbers);
}

}  // namespace colmap_ext
