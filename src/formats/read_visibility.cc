#include "formats/read_visibility.h"

#include <string>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {

Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points,
                          const VisibilityOwner& owner) {
  const std::string what_to_do = std::string("; ") + owner.what_to_do;
  if (!std::filesystem::exists(path)) {
    throw FileError(path,
                    "no such file, so it is not known which images see the "
                    "points" +
                        what_to_do,
                    owner.alternative);
  }
  ByteReader reader(path);
  const uint64_t count = reader.Read<uint64_t>("the number of points");
  if (count != num_points) {
    throw FileError(
        path,
        fmt::format(
            "is about {} points, but the {} has {}: was the {} edited?{}",
            count, owner.name, num_points, owner.name, what_to_do),
        owner.alternative);
  }
  if (count > reader.Remaining() / sizeof(uint32_t)) {
    throw FileError(
        path,
        fmt::format("truncated or damaged: no room for {} points", count));
  }
  Visibility visibility;
  visibility.offsets.reserve(num_points + 1);
  visibility.values.reserve(reader.Remaining() / sizeof(uint32_t) - num_points);
  for (size_t i = 0; i < num_points; ++i) {
    const uint32_t num_images = reader.Read<uint32_t>("a point's images");
    if (num_images > reader.Remaining() / sizeof(uint32_t)) {
      throw FileError(
          path, fmt::format("truncated or damaged: point {} promises {} images",
                            i, num_images));
    }
    const size_t begin = visibility.values.size();
    visibility.values.resize(begin + num_images);
    reader.Read(visibility.values.data() + begin, num_images * sizeof(uint32_t),
                "a point's images");
    visibility.EndRow();
  }
  reader.ExpectEnd();
  return visibility;
}

}  // namespace colmap_ext
