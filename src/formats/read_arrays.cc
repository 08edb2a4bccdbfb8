#include "formats/read_arrays.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

constexpr const char* kNotADepthMap = "not a depth map of COLMAP";

// Digits and the & behind them.
int ReadHeaderNumber(ByteReader* reader) {
  constexpr int kMaxDigits = 8;
  int number = 0;
  for (int i = 0; i <= kMaxDigits && reader->Remaining() > 0; ++i) {
    const char c = reader->Read<char>("the header");
    if (c == '&' && number > 0) {
      return number;
    }
    if (c < '0' || c > '9') {
      break;
    }
    number = 10 * number + (c - '0');
  }
  reader->Throw(kNotADepthMap);
}

constexpr const char* kHeader = "the header";

// The Python dictionary that says what the array is. NumPy's format:
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
std::string ReadHeader(ByteReader* reader) {
  constexpr char kMagic[] = "\x93NUMPY";
  constexpr size_t kMagicSize = sizeof(kMagic) - 1;
  char magic[kMagicSize];
  reader->Read(magic, kMagicSize, kHeader);
  if (std::memcmp(magic, kMagic, kMagicSize) != 0) {
    reader->Throw("not a NumPy file");
  }
  const auto major = reader->Read<uint8_t>(kHeader);
  reader->Skip(1, kHeader);  // minor version
  const size_t length = major == 1 ? reader->Read<uint16_t>(kHeader)
                                   : reader->Read<uint32_t>(kHeader);
  constexpr size_t kMaxLength = 1 << 16;
  if (length > kMaxLength) {
    reader->Throw("not a NumPy file: endless header");
  }
  std::string header(length, ' ');
  reader->Read(header.data(), length, kHeader);
  return header;
}

// The text of a value in the dictionary, from its first character on; empty if
// there is none. Regular expressions are not used: those of the standard
// library need a stack that grows with the text.
std::string_view FindValue(std::string_view header, std::string_view key) {
  const size_t begin = header.find(key);
  if (begin == std::string_view::npos) {
    return {};
  }
  std::string_view value = header.substr(begin + key.size());
  value.remove_prefix(std::min(value.find_first_not_of(" \t:"), value.size()));
  return value;
}

// One byte each, as NumPy names them.
bool IsByteType(std::string_view type) {
  return type.starts_with("'|u1'") || type.starts_with("'|i1'") ||
         type.starts_with("'|b1'");
}

// "(X, Y, Z)"
std::optional<std::array<size_t, 3>> ParseSize(std::string_view shape) {
  constexpr size_t kMaxSize = 999999;  // so that the product fits
  std::istringstream text{std::string(shape)};
  std::array<size_t, 3> size{};
  std::array<char, 4> marks{};
  text >> marks[0] >> size[0] >> marks[1] >> size[1] >> marks[2] >> size[2] >>
      marks[3];
  return text && std::string_view(marks.data(), 4) == "(,,)" &&
                 std::ranges::max(size) <= kMaxSize
             ? std::optional(size)
             : std::nullopt;
}

// From x fastest to z fastest.
std::vector<uint8_t> FromFortranOrder(const std::vector<uint8_t>& voxels,
                                      const std::array<size_t, 3>& size) {
  const auto [size_x, size_y, size_z] = size;
  std::vector<uint8_t> reordered(voxels.size());
  for (size_t i = 0; i < voxels.size(); ++i) {
    const size_t x = i % size_x;
    const size_t y = i / size_x % size_y;
    const size_t z = i / size_x / size_y;
    reordered[(x * size_y + y) * size_z + z] = voxels[i];
  }
  return reordered;
}

}  // namespace

DepthMap ReadDepthMapHeader(ByteReader* reader) {
  DepthMap map;
  map.width = ReadHeaderNumber(reader);
  map.height = ReadHeaderNumber(reader);
  if (ReadHeaderNumber(reader) != 1) {
    reader->Throw(kNotADepthMap);
  }
  return map;
}

DepthMap ReadDepthMap(const std::filesystem::path& path) {
  ByteReader reader(path);
  DepthMap map = ReadDepthMapHeader(&reader);
  const uint64_t num_depths = uint64_t{1} * map.width * map.height;
  if (num_depths > reader.Remaining() / sizeof(float)) {
    reader.Throw(fmt::format("truncated: it has no room for {} x {} depths",
                             map.width, map.height));
  }
  map.depths.resize(num_depths);
  reader.Read(map.depths.data(), num_depths * sizeof(float), "the depths");
  reader.ExpectEnd();
  return map;
}

std::filesystem::path FindDepthMap(const std::filesystem::path& folder,
                                   const std::string& image_name) {
  std::error_code error;
  for (const char* ending : {".geometric.bin", ".photometric.bin", ".bin"}) {
    const std::filesystem::path path = folder / (image_name + ending);
    if (std::filesystem::is_regular_file(path, error)) {
      return path;
    }
  }
  return {};
}

VoxelGrid ReadNpyMask(const std::filesystem::path& path) {
  ByteReader reader(path);
  const std::string header = ReadHeader(&reader);
  const auto size = ParseSize(FindValue(header, "'shape'"));
  if (!IsByteType(FindValue(header, "'descr'")) || !size) {
    reader.Throw(
        "not a mask: an array of uint8 or bool with three dimensions is "
        "expected");
  }
  const auto [size_x, size_y, size_z] = *size;
  const size_t num_voxels = size_x * size_y * size_z;
  if (num_voxels > reader.Remaining()) {
    reader.Throw("truncated: it has no room for its array");
  }
  VoxelGrid mask{*size, std::vector<uint8_t>(num_voxels)};
  reader.Read(mask.voxels.data(), num_voxels, "the array");
  reader.ExpectEnd();
  if (FindValue(header, "'fortran_order'").starts_with("True")) {
    mask.voxels = FromFortranOrder(mask.voxels, mask.size);
  }
  return mask;
}

}  // namespace colmap_ext
