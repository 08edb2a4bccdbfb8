#include "colmap_ext/write_png.h"

#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include "colmap_ext/colmap_compat.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {

void WritePng(const std::filesystem::path& path, const ColorImage& image) {
  // COLMAP writes to a path of its own choice of format, not to our file.
  const std::filesystem::path draft =
      std::filesystem::path(path).replace_extension(".draft.png");
  std::vector<char> bytes;
  if (WriteColorImage(draft, image)) {
    std::ifstream stream(draft, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(stream), {});
  }
  std::error_code ignored;
  std::filesystem::remove(draft, ignored);
  if (bytes.empty()) {
    throw FileError(path, "can not be written");
  }
  AtomicFile file(path);
  file.Write(bytes.data(), bytes.size());
  AtomicFile* const files[] = {&file};
  Commit(files);
}

}  // namespace colmap_ext
