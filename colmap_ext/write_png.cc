#include "colmap_ext/write_png.h"

#include "formats/atomic_file.h"
#include "formats/encode_png.h"

namespace colmap_ext {

void WritePng(const std::filesystem::path& path, const ColorImage& image) {
  WriteText(path, EncodePng(image));
}

}  // namespace colmap_ext
