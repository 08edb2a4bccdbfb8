#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace colmap_ext {

// What the user can request instead, if a file does not allow something. The
// caller knows the option's name and can append it to the message.
enum class Alternative {
  kSayImageOrder,     // WorkspaceOptions::image_order
  kOtherImageOrder,   // another one
  kUseSparsePoints,   // WorkspaceOptions::input_type
  kLeavePicturesOut,  // call RemoveUnusable() in place of ExpectPictures()
};

// A file or folder that is missing, damaged, or does not fit the others. The
// message is one line for the user: what is wrong where, and what to do.
class FileError : public std::runtime_error {
 public:
  FileError(const std::filesystem::path& path, const std::string& message,
            std::optional<Alternative> alternative = std::nullopt)
      : std::runtime_error(path.string() + ": " + message),
        alternative_(alternative) {}

  std::optional<Alternative> GetAlternative() const { return alternative_; }

 private:
  std::optional<Alternative> alternative_;
};

}  // namespace colmap_ext
