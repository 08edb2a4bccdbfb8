#include "tests/fuzz/fuzzed_sparse_model.h"

#include <stdlib.h>

#include <stdexcept>

#include "formats/errors.h"
#include "workspace/image_order.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

namespace {

constexpr const char* kNames[] = {"cameras", "images", "points3D", "frames"};

}  // namespace

FuzzedSparseModel::FuzzedSparseModel(const std::string& extension,
                                     const std::array<std::string, 4>& files)
    : sound_(files) {
  std::string folder =
      (std::filesystem::temp_directory_path() / "colmap_ext_fuzz_XXXXXX")
          .string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error("no temporary folder");
  }
  folder_ = folder;
  for (size_t i = 0; i < files_.size(); ++i) {
    files_[i].Set(sound_[i].data(), sound_[i].size());
    std::filesystem::create_symlink(files_[i].Path(),
                                    folder_ / (kNames[i] + extension));
  }
}

FuzzedSparseModel::~FuzzedSparseModel() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void FuzzedSparseModel::Fuzz(const uint8_t* bytes, size_t num_bytes) {
  if (num_bytes == 0) {
    return;
  }
  const size_t fuzzed = bytes[0] % files_.size();
  files_[fuzzed].Set(bytes + 1, num_bytes - 1);
  try {
    CandidateImageOrders(ReadSparseModel(folder_));
  } catch (const FileError&) {
  }
  files_[fuzzed].Set(sound_[fuzzed].data(), sound_[fuzzed].size());
}

}  // namespace colmap_ext
