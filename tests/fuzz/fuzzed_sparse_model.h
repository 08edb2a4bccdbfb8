#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/fuzz/memory_file.h"

namespace colmap_ext {

// A folder with the four files of a sparse model in memory: cameras, images,
// points3D and frames. All are sound but one.
class FuzzedSparseModel {
 public:
  // \param extension  ".bin" or ".txt".
  // \param files  the contents of the sound ones.
  FuzzedSparseModel(const std::string& extension,
                    const std::array<std::string, 4>& files);
  ~FuzzedSparseModel();
  FuzzedSparseModel(const FuzzedSparseModel&) = delete;
  FuzzedSparseModel& operator=(const FuzzedSparseModel&) = delete;

  // Reads the model with one of its files, which the first byte names, replaced
  // by the bytes behind that.
  void Fuzz(const uint8_t* bytes, size_t num_bytes);

 private:
  std::filesystem::path folder_;
  std::array<std::string, 4> sound_;
  std::array<MemoryFile, 4> files_;
};

}  // namespace colmap_ext
