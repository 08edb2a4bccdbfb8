#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "colmap_ext/options/command_options.h"

namespace colmap_ext {

// A hash that detects accidental changes; it offers no security.
// \param hash  of the bytes before
uint64_t HashBytes(std::string_view bytes, uint64_t hash = 0);

// The size of a file and a hash of its bytes, as "N bytes, hash H"; "none" if
// it can not be read. Files of more than 16 MB are sampled at 64 places.
std::string Fingerprint(const std::filesystem::path& path);

// All that the result of a job depends on, except the program itself and its
// backend. A job whose inputs differ does not use files of another.
struct JobInputs {
  using Values = std::map<std::string, std::string>;

  Values options;  // as they are typed, by name
  Values files;    // fingerprints, by name or path

  void AddOptions(const CommandOptions& command);

  // Computes the fingerprints in parallel.
  void AddFiles(
      const std::vector<std::pair<std::string, std::filesystem::path>>& named);
  // The same by absolute paths.
  void AddFiles(const std::vector<std::filesystem::path>& paths);

  // Sets those of a command's options that are inputs.
  // \return the name of one without a valid value; empty: all are valid
  std::string SetOptions(const CommandOptions& command) const;

  // The first difference to the inputs of an earlier job, as "iterations was
  // '10' and is '3'"; empty: none.
  std::string DifferenceTo(const JobInputs& earlier) const;

  // \param version  of the job's files
  uint64_t Hash(int version) const;
};

}  // namespace colmap_ext
