#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace colmap_ext {

struct VoxelGrid {
  std::array<size_t, 3> size{};  // X, Y, Z
  std::vector<uint8_t> voxels;   // [X, Y, Z], z fastest
};

// Reads the voxels of an observability mask from a NumPy file (.npy, format 1.0
// to 3.0): an array [X, Y, Z] of uint8, int8 or bool, in C or Fortran order.
// DTU's ObsMask*.mat become such by
//   numpy.save(npy_path, scipy.io.loadmat(mat_path)["ObsMask"]).
//
// \throw FileError if the file is missing, truncated, or not such an array.
VoxelGrid ReadNpyMask(const std::filesystem::path& path);

}  // namespace colmap_ext
