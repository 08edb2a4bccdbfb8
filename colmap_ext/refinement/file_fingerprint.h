#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_ext {

// The size of a file and a hash of its bytes (FNV-1a of 64 bits
// [FowlerNollVo]), as "N bytes, hash H"; "none" if it can not be read. Tells
// files apart that were changed by accident, not by an attacker.
std::string Fingerprint(const std::filesystem::path& path);

// [paths] The fingerprint of each, read in parallel.
std::vector<std::string> Fingerprints(
    const std::vector<std::filesystem::path>& paths);

}  // namespace colmap_ext
