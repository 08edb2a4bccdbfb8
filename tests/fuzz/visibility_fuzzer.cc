#include <cstring>

#include "formats/read_visibility.h"
#include "tests/fuzz/fuzz_file.h"
#include "workspace/filter_cloud.h"

namespace colmap_ext {

namespace {

// The cloud has as many points as the file says, or 3.
void ReadAndFilter(const std::filesystem::path& path, uint64_t num_points) {
  constexpr size_t kNumImages = 5;
  Visibility visibility = ReadVisibility(path, num_points);
  PlyCloud cloud;
  cloud.positions.resize(visibility.size(), Eigen::Vector3f::Zero());
  FilterReport report;
  FilterCloud(std::move(cloud), std::move(visibility), kNumImages, &report);
}

}  // namespace

}  // namespace colmap_ext

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  uint64_t num_points = 3;
  if (num_bytes >= sizeof(num_points)) {
    std::memcpy(&num_points, bytes, sizeof(num_points));
  }
  return colmap_ext::FuzzFile(bytes, num_bytes,
                              [num_points](const std::filesystem::path& path) {
                                colmap_ext::ReadAndFilter(path, num_points);
                              });
}
