#pragma once

#include <optional>
#include <string>

#include "workspace/image_order.h"

namespace colmap_ext {

// The order that the word of --image_order names; nothing for "auto".
// \throw OptionError if it is no such word.
std::optional<ImageOrderKind> ParseImageOrder(const std::string& word);

}  // namespace colmap_ext
