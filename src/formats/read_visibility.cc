#include "formats/read_visibility.h"

#include <string>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

// \throw FileError if there is none, as ByteReader does not say what it is for
const std::filesystem::path& ExpectThere(const std::filesystem::path& path,
                                         const VisibilityOwner& owner) {
  if (!std::filesystem::exists(path)) {
    throw FileError(path,
                    std::string("no such file, so it is not known which images "
                                "see the points; ") +
                        owner.what_to_do,
                    owner.alternative);
  }
  return path;
}

}  // namespace

VisibilityReader::VisibilityReader(const std::filesystem::path& path,
                                   size_t num_points,
                                   const VisibilityOwner& owner)
    : reader_(ExpectThere(path, owner)) {
  const uint64_t count = reader_.Read<uint64_t>("the number of points");
  if (count != num_points) {
    throw FileError(
        path,
        fmt::format(
            "is about {} points, but the {} has {}: was the {} edited?; {}",
            count, owner.name, num_points, owner.name, owner.what_to_do),
        owner.alternative);
  }
  if (count > reader_.Remaining() / sizeof(uint32_t)) {
    reader_.Throw(
        fmt::format("truncated or damaged: no room for {} points", count));
  }
}

void VisibilityReader::Read(size_t num_points, Visibility* visibility) {
  for (size_t i = 0; i < num_points; ++i, ++point_) {
    const uint32_t num_images = reader_.Read<uint32_t>("a point's images");
    if (num_images > reader_.Remaining() / sizeof(uint32_t)) {
      reader_.Throw(
          fmt::format("truncated or damaged: point {} promises {} images",
                      point_, num_images));
    }
    const size_t begin = visibility->values.size();
    visibility->values.resize(begin + num_images);
    reader_.Read(visibility->values.data() + begin,
                 num_images * sizeof(uint32_t), "a point's images");
    visibility->EndRow();
  }
}

Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points,
                          const VisibilityOwner& owner) {
  VisibilityReader reader(path, num_points, owner);
  Visibility visibility;
  visibility.offsets.reserve(num_points + 1);
  visibility.values.reserve(reader.RemainingBytes() / sizeof(uint32_t) -
                            num_points);
  reader.Read(num_points, &visibility);
  reader.ExpectEnd();
  return visibility;
}

}  // namespace colmap_ext
