#include "formats/read_depth_map.h"

#include <string>

#include <fmt/format.h>

#include "formats/errors.h"

namespace colmap_ext {

namespace {

[[noreturn]] void ThrowNotADepthMap(const ByteReader& reader) {
  throw FileError(reader.Path(), "not a depth map of COLMAP");
}

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
  ThrowNotADepthMap(*reader);
}

}  // namespace

DepthMapSize ReadDepthMapHeader(ByteReader* reader) {
  DepthMapSize size;
  size.width = ReadHeaderNumber(reader);
  size.height = ReadHeaderNumber(reader);
  if (ReadHeaderNumber(reader) != 1) {
    ThrowNotADepthMap(*reader);
  }
  return size;
}

DepthMap ReadDepthMap(const std::filesystem::path& path) {
  ByteReader reader(path);
  const DepthMapSize size = ReadDepthMapHeader(&reader);
  const uint64_t num_depths = uint64_t{1} * size.width * size.height;
  if (num_depths > reader.Remaining() / sizeof(float)) {
    throw FileError(path,
                    fmt::format("truncated: it has no room for {} x {} depths",
                                size.width, size.height));
  }
  DepthMap map;
  map.width = size.width;
  map.height = size.height;
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

}  // namespace colmap_ext
