#include "colmap_ext/read_visibility.h"

#include "colmap_ext/byte_reader.h"
#include "colmap_ext/errors.h"

namespace colmap_ext {

namespace {

// What users bring: a cloud that was cropped or cleaned in an editor, which
// leaves the .vis behind (COLMAP's issue 592), or that never had one (966).
constexpr const char* kWhatToDo =
    "; run `colmap stereo_fusion` again, whose two files belong together, or "
    "crop with a tool that drops the same points from both, or mesh the "
    "sparse points with --input_type sparse";

}  // namespace

Visibility ReadVisibility(const std::filesystem::path& path,
                          size_t num_points) {
  if (!std::filesystem::exists(path)) {
    throw FileError(path, std::string("no such file, so it is not known which "
                                      "images see the points") +
                              kWhatToDo);
  }
  ByteReader reader(path);
  const uint64_t count = reader.Read<uint64_t>("the number of points");
  if (count != num_points) {
    throw FileError(path, "is about " + std::to_string(count) +
                              " points, but the cloud has " +
                              std::to_string(num_points) +
                              ": was the cloud edited?" + kWhatToDo);
  }
  if (count > reader.Remaining() / sizeof(uint32_t)) {
    throw FileError(path, "truncated or damaged: no room for " +
                              std::to_string(count) + " points");
  }
  Visibility visibility;
  visibility.offsets.reserve(num_points + 1);
  visibility.image_indices.reserve(reader.Remaining() / sizeof(uint32_t) -
                                   num_points);
  for (size_t i = 0; i < num_points; ++i) {
    const uint32_t num_images = reader.Read<uint32_t>("a point's images");
    if (num_images > reader.Remaining() / sizeof(uint32_t)) {
      throw FileError(path, "truncated or damaged: point " + std::to_string(i) +
                                " promises " + std::to_string(num_images) +
                                " images");
    }
    const size_t begin = visibility.image_indices.size();
    visibility.image_indices.resize(begin + num_images);
    reader.Read(visibility.image_indices.data() + begin,
                num_images * sizeof(uint32_t), "a point's images");
    visibility.offsets.push_back(visibility.image_indices.size());
  }
  reader.ExpectEnd();
  return visibility;
}

}  // namespace colmap_ext
