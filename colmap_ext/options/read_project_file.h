#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace colmap_ext {

// The options of a project file as COLMAP's project_generator writes it: lines
// `name=value`, in sections `[Section]` whose options are "Section.name"; `#`
// starts a comment. Spaces around names and values do not count.
// \return the values by name.
// \throw OptionError if the file can not be read, a line is none of these, or
//        an option is there twice.
std::map<std::string, std::string> ReadProjectFile(
    const std::filesystem::path& path);

}  // namespace colmap_ext
