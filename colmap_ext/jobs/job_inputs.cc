#include "colmap_ext/jobs/job_inputs.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/mix_bits.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

std::string ValueIn(const JobInputs::Values& values, const std::string& name) {
  const auto found = values.find(name);
  return found != values.end() ? found->second : "";
}

std::string Difference(const JobInputs::Values& before,
                       const JobInputs::Values& now) {
  JobInputs::Values all = before;
  all.insert(now.begin(), now.end());
  for (const auto& [name, value] : all) {
    const std::string was = ValueIn(before, name);
    const std::string is = ValueIn(now, name);
    if (was != is) {
      return fmt::format("{} was '{}' and is '{}'", name, was, is);
    }
  }
  return "";
}

}  // namespace

uint64_t HashBytes(std::string_view bytes, uint64_t hash) {
  // Four sums, because a processor computes as many at a time.
  std::array<uint64_t, 4> sums = {1, 2, 3, 4};
  for (size_t i = 0; i < bytes.size(); i += sizeof(sums)) {
    std::array<uint64_t, 4> words = {};
    std::memcpy(words.data(), bytes.data() + i,
                std::min(sizeof(sums), bytes.size() - i));
    for (size_t k = 0; k < 4; ++k) {
      sums[k] = (sums[k] ^ words[k]) * kSplitMixStep;
      sums[k] ^= sums[k] >> 32;
    }
  }
  hash = MixBits(hash + bytes.size());
  for (const uint64_t sum : sums) {
    hash = MixBits(hash + sum);
  }
  return hash;
}

std::string Fingerprint(const fs::path& path) {
  constexpr uint64_t kNumSamples = 64;
  constexpr uint64_t kSampleBytes = 1 << 18;
  std::error_code error;
  const uint64_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    return "none";
  }
  constexpr uint64_t kGaps = kNumSamples - 1;
  const uint64_t last = size - std::min(size, kSampleBytes);
  const uint64_t step = std::max(kSampleBytes, (last + kGaps - 1) / kGaps);
  uint64_t hash = 0;
  std::string sample(std::min(size, kSampleBytes), '\0');
  for (uint64_t begin = 0; begin < size; begin += step) {
    file.clear();
    file.seekg(static_cast<std::streamoff>(begin));
    file.read(sample.data(), static_cast<std::streamsize>(sample.size()));
    hash = HashBytes({sample.data(), static_cast<size_t>(file.gcount())}, hash);
  }
  return fmt::format("{} bytes, hash {:016x}", size, hash);
}

void JobInputs::AddOptions(const CommandOptions& command) {
  for (const CommandOptions::Option& option : command.Options()) {
    options[option.name] = option.text();
  }
}

void JobInputs::AddFiles(
    const std::vector<std::pair<std::string, fs::path>>& named) {
  std::vector<std::string> fingerprints(named.size());
  tbb::parallel_for(size_t{0}, named.size(), [&](size_t i) {
    fingerprints[i] = Fingerprint(named[i].second);
  });
  for (size_t i = 0; i < named.size(); ++i) {
    files[named[i].first] = fingerprints[i];
  }
}

void JobInputs::AddFiles(const std::vector<fs::path>& paths) {
  std::vector<std::pair<std::string, fs::path>> named;
  for (const fs::path& path : paths) {
    named.emplace_back(fs::absolute(path).string(), path);
  }
  AddFiles(named);
}

std::string JobInputs::SetOptions(const CommandOptions& command) const {
  for (const CommandOptions::Option& option : command.Options()) {
    const auto found = options.find(option.name);
    if (found != options.end() && !option.set(found->second)) {
      return option.name;
    }
  }
  return "";
}

std::string JobInputs::DifferenceTo(const JobInputs& earlier) const {
  const std::string difference = Difference(earlier.options, options);
  return difference.empty() ? Difference(earlier.files, files) : difference;
}

uint64_t JobInputs::Hash(int version) const {
  uint64_t hash = HashBytes(std::to_string(version));
  for (const Values* values : {&options, &files}) {
    for (const auto& [name, value] : *values) {
      hash = HashBytes(fmt::format("{}={}\n", name, value), hash);
    }
  }
  return hash;
}

}  // namespace colmap_ext
