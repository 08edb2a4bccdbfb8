#include "formats/read_depth_map.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  return colmap_ext::FuzzFile(bytes, num_bytes,
                              [](const std::filesystem::path& path) {
                                colmap_ext::ReadDepthMap(path);
                              });
}
