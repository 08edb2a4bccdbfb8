#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "formats/byte_reader.h"
#include "scene/images.h"

namespace colmap_ext {

// The header of a depth map of patch_match_stereo, the text
// "WIDTH&HEIGHT&CHANNELS&".
// \return a map of this size, without depths.
// \throw FileError if it is not that, or not of one channel.
DepthMap ReadDepthMapHeader(ByteReader* reader);

// A depth map in COLMAP's format, of the whole image.
// \throw FileError if the file is missing, truncated, or not such a map.
DepthMap ReadDepthMap(const std::filesystem::path& path);

// The file of an image's depth map in a folder of such: NAME.geometric.bin,
// NAME.photometric.bin or NAME.bin, the first that is there.
// \return an empty path if there is none.
std::filesystem::path FindDepthMap(const std::filesystem::path& folder,
                                   const std::string& image_name);

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
