// NumPy's format: https://numpy.org/doc/stable/reference/generated/
// numpy.lib.format.html

#include "formats/read_npy_mask.h"

#include <cstdint>
#include <cstring>
#include <regex>
#include <string>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {

namespace {

constexpr const char* kHeader = "the header";

// The Python dictionary that says what the array is.
std::string ReadHeader(ByteReader* reader) {
  constexpr char kMagic[] = "\x93NUMPY";
  constexpr size_t kMagicSize = sizeof(kMagic) - 1;
  char magic[kMagicSize];
  reader->Read(magic, kMagicSize, kHeader);
  if (std::memcmp(magic, kMagic, kMagicSize) != 0) {
    throw FileError(reader->Path(), "not a NumPy file");
  }
  const auto major = reader->Read<uint8_t>(kHeader);
  reader->Skip(1, kHeader);  // minor version
  const size_t length = major == 1 ? reader->Read<uint16_t>(kHeader)
                                   : reader->Read<uint32_t>(kHeader);
  constexpr size_t kMaxLength = 1 << 16;
  if (length > kMaxLength) {
    throw FileError(reader->Path(), "not a NumPy file: endless header");
  }
  std::string header(length, ' ');
  reader->Read(header.data(), length, kHeader);
  return header;
}

std::array<size_t, 3> ParseShape(const std::string& header,
                                 const std::filesystem::path& path) {
  static const std::regex kBytes("'descr':\\s*'[|<>=]?(u1|i1|b1|\\?)'");
  static const std::regex kShape(
      "'shape':\\s*\\((\\d{1,6}), (\\d{1,6}), (\\d{1,6})\\)");
  std::smatch shape;
  if (!std::regex_search(header, kBytes) ||
      !std::regex_search(header, shape, kShape)) {
    throw FileError(path,
                    "not a mask: an array of uint8 or bool with three "
                    "dimensions is expected");
  }
  return {std::stoul(shape[1]), std::stoul(shape[2]), std::stoul(shape[3])};
}

}  // namespace

VoxelGrid ReadNpyMask(const std::filesystem::path& path) {
  ByteReader reader(path);
  const std::string header = ReadHeader(&reader);
  VoxelGrid mask;
  mask.size = ParseShape(header, path);
  const auto [size_x, size_y, size_z] = mask.size;
  const size_t num_voxels = size_x * size_y * size_z;
  if (num_voxels > reader.Remaining()) {
    throw FileError(path, "truncated: it has no room for its array");
  }
  mask.voxels.resize(num_voxels);
  reader.Read(mask.voxels.data(), num_voxels, "the array");
  reader.ExpectEnd();
  static const std::regex kFortran("'fortran_order':\\s*True");
  if (std::regex_search(header, kFortran)) {  // x fastest
    const std::vector<uint8_t> voxels = mask.voxels;
    for (size_t i = 0; i < num_voxels; ++i) {
      const size_t x = i % size_x;
      const size_t y = i / size_x % size_y;
      const size_t z = i / size_x / size_y;
      mask.voxels[(x * size_y + y) * size_z + z] = voxels[i];
    }
  }
  return mask;
}

}  // namespace colmap_ext
