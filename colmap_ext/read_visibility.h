#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace colmap_ext {

// Which images see each point, as the file has it: not sorted, not checked.
struct Visibility {
  std::vector<uint64_t> offsets{0};  // [P + 1], into image_indices
  std::vector<uint32_t> image_indices;
};

// Reads a fused.ply.vis: uint64 P, then for each point uint32 n and n times
// uint32 image index, little-endian.
//
// \param num_points  of the cloud beside it.
// \throw FileError if the file is missing, truncated, too long, or of another
//        number of points; it says what to do. Never allocates more than the
//        file's size justifies.
Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points);

}  // namespace colmap_ext
