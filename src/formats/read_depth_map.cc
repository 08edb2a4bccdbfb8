#include "formats/read_depth_map.h"

#include <string>

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

}  // namespace colmap_ext
