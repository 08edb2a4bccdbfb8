#include "formats/read_numbers.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  return colmap_ext::FuzzFile(
      bytes, num_bytes,
      [](const std::filesystem::path& path) { colmap_ext::ReadRegion(path); });
}
