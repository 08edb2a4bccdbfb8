#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/lru_cache.h"
#include "colmap_ext/tiling/section_file.h"

namespace colmap_ext {

// The files of all tiles of a plan, one kind of them. A plan may have more
// tiles than a process may open files, so that only those used last are open.
class TileFiles {
 public:
  // \param path_of  the file of a tile
  // \param kind, identity, num_sections  see SectionReader
  // \throw FileError if one is missing, damaged or of another plan
  TileFiles(std::function<std::filesystem::path(size_t tile)> path_of,
            std::string kind, uint64_t identity, uint64_t num_sections,
            size_t num_tiles);

  // Safe from several threads.
  // \throw FileError
  std::shared_ptr<const SectionReader> Open(size_t tile) const;

 private:
  std::function<std::filesystem::path(size_t tile)> path_of_;
  std::string kind_;
  uint64_t identity_;
  uint64_t num_sections_;
  mutable LruCache<const SectionReader> open_;
};

}  // namespace colmap_ext
