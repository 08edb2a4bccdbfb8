#include "colmap_ext/refinement/file_fingerprint.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace colmap_ext {

namespace fs = std::filesystem;

uint64_t HashBytes(std::string_view bytes, uint64_t hash) {
  constexpr uint64_t kPrime = 0x100000001b3;  // [FowlerNollVo]
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<uint8_t>(byte)) * kPrime;
  }
  return hash;
}

std::string Fingerprint(const fs::path& path) {
  constexpr size_t kBufferSize = 1 << 18;  // bytes
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) {
    return "none";
  }
  uint64_t hash = HashBytes("");
  uint64_t size = 0;
  std::string buffer(kBufferSize, '\0');
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())),
         file.gcount() > 0) {
    const auto count = static_cast<size_t>(file.gcount());
    hash = HashBytes({buffer.data(), count}, hash);
    size += count;
  }
  return fmt::format("{} bytes, hash {:016x}", size, hash);
}

std::vector<std::string> Fingerprints(const std::vector<fs::path>& paths) {
  std::vector<std::string> fingerprints(paths.size());
  tbb::parallel_for(size_t{0}, paths.size(),
                    [&](size_t i) { fingerprints[i] = Fingerprint(paths[i]); });
  return fingerprints;
}

std::string QuickFingerprint(const fs::path& path) {
  constexpr uint64_t kNumSamples = 64;
  constexpr uint64_t kSampleBytes = 16384;
  std::error_code error;
  const uint64_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    return "none";
  }
  uint64_t hash = HashBytes("");
  std::string sample(kSampleBytes, '\0');
  for (uint64_t i = 0; i < kNumSamples; ++i) {
    const uint64_t last = size - std::min(size, kSampleBytes);
    file.clear();
    file.seekg(static_cast<std::streamoff>(last * i / (kNumSamples - 1)));
    file.read(sample.data(), static_cast<std::streamsize>(kSampleBytes));
    hash = HashBytes({sample.data(), static_cast<size_t>(file.gcount())}, hash);
  }
  return fmt::format("{} bytes, samples {:016x}", size, hash);
}

}  // namespace colmap_ext
