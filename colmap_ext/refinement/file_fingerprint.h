#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace colmap_ext {

// FNV-1a of 64 bits [FowlerNollVo].
// \param hash  of what comes before the bytes
uint64_t HashBytes(std::string_view bytes, uint64_t hash = 0xcbf29ce484222325);

// The size of a file and HashBytes() of it, as "N bytes, hash H"; "none" if it
// can not be read. Tells files apart that were changed by accident, not by an
// attacker.
std::string Fingerprint(const std::filesystem::path& path);

// [paths] The fingerprint of each, read in parallel.
std::vector<std::string> Fingerprints(
    const std::vector<std::filesystem::path>& paths);

// The same of samples of the file, so that it costs next to nothing.
std::string QuickFingerprint(const std::filesystem::path& path);

}  // namespace colmap_ext
