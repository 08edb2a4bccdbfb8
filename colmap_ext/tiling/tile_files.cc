#include "colmap_ext/tiling/tile_files.h"

#include <utility>

namespace colmap_ext {
namespace {

// Files that are open at once. Of the 1,024 that a process may usually open
// the merger needs twice as many, and some more. A choice.
constexpr size_t kMaxOpen = 128;

}  // namespace

TileFiles::TileFiles(std::function<std::filesystem::path(size_t tile)> path_of,
                     std::string kind, uint64_t identity, uint64_t num_sections,
                     size_t num_tiles)
    : path_of_(std::move(path_of)),
      kind_(std::move(kind)),
      identity_(identity),
      num_sections_(num_sections),
      open_(kMaxOpen) {
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    Open(tile);
  }
}

std::shared_ptr<const SectionReader> TileFiles::Open(size_t tile) const {
  return open_.Get(tile, 1, [&] {
    return std::make_shared<const SectionReader>(path_of_(tile), kind_,
                                                 identity_, num_sections_);
  });
}

}  // namespace colmap_ext
