#include "colmap_ext/refinement/file_fingerprint.h"

#include <cstdint>
#include <fstream>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace colmap_ext {

std::string Fingerprint(const std::filesystem::path& path) {
  constexpr uint64_t kOffsetBasis = 0xcbf29ce484222325;  // [FowlerNollVo]
  constexpr uint64_t kPrime = 0x100000001b3;             // [FowlerNollVo]
  constexpr size_t kBufferSize = 1 << 18;                // bytes
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) {
    return "none";
  }
  uint64_t hash = kOffsetBasis;
  uint64_t size = 0;
  std::vector<char> buffer(kBufferSize);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())),
         file.gcount() > 0) {
    const auto count = static_cast<size_t>(file.gcount());
    for (size_t i = 0; i < count; ++i) {
      hash = (hash ^ static_cast<uint8_t>(buffer[i])) * kPrime;
    }
    size += count;
  }
  return fmt::format("{} bytes, hash {:016x}", size, hash);
}

std::vector<std::string> Fingerprints(
    const std::vector<std::filesystem::path>& paths) {
  std::vector<std::string> fingerprints(paths.size());
  tbb::parallel_for(size_t{0}, paths.size(),
                    [&](size_t i) { fingerprints[i] = Fingerprint(paths[i]); });
  return fingerprints;
}

}  // namespace colmap_ext
