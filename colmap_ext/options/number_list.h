#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace colmap_ext {

// The finite numbers of an option, "1,2,3".
// \param option  its name, for the message.
// \param count   how many there have to be; 0: one or more
// \throw OptionError if there is anything else, or another number of them.
std::vector<double> ParseNumberList(const std::string& option,
                                    const std::string& text, size_t count);

}  // namespace colmap_ext
