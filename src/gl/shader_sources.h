#pragma once

#include <string_view>

namespace colmap_ext {

// The text of a file of shaders/, which is part of the program.
// \param name  of the file, without folders.
// \throw std::out_of_range if there is no such file.
std::string_view ShaderSource(std::string_view name);

}  // namespace colmap_ext
