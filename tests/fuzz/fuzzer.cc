// Fuzzes the reader of files that the environment variable FUZZED names. The
// readers may refuse a file by a FileError; whatever else happens is a fault.

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "formats/picture_files.h"
#include "formats/read_arrays.h"
#include "formats/read_numbers.h"
#include "formats/read_ply.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/image_order.h"
#include "workspace/workspace.h"

namespace colmap_ext {
namespace {

// A file in memory that is read by a path as any other file.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    if (descriptor_ < 0) {
      throw std::runtime_error("no file in memory");
    }
    path_ = "/proc/" + std::to_string(getpid()) + "/fd/" +
            std::to_string(descriptor_);
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  // Replaces what is in the file.
  void Set(std::string_view bytes) {
    if (ftruncate(descriptor_, 0) != 0 ||
        pwrite(descriptor_, bytes.data(), bytes.size(), 0) !=
            static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the file in memory cannot be written");
    }
  }

  const std::filesystem::path& Path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

// The cloud has as many points as the file says, or 3.
void FuzzVisibility(const std::filesystem::path& path, std::string_view bytes) {
  constexpr size_t kNumImages = 5;
  uint64_t num_points = 3;
  if (bytes.size() >= sizeof(num_points)) {
    std::memcpy(&num_points, bytes.data(), sizeof(num_points));
  }
  Visibility visibility = ReadVisibility(path, num_points);
  PlyCloud cloud;
  cloud.positions.resize(visibility.size(), Eigen::Vector3f::Zero());
  FilterReport report;
  FilterCloud(std::move(cloud), std::move(visibility), kNumImages, &report);
}

// A sparse model in memory, whose files are sound but one: the first byte names
// that file, and what follows is in it.
void FuzzSparseModel(const std::string& extension, std::string_view bytes) {
  struct Model {
    TemporaryFolder folder;
    std::array<std::string, 4> sound;
    std::array<MemoryFile, 4> files;

    explicit Model(const std::string& extension) {
      constexpr const char* kNames[] = {"cameras", "images", "points3D",
                                        "frames"};
      for (size_t i = 0; i < files.size(); ++i) {
        const std::string name = kNames[i] + extension;
        sound[i] = SphereWorkspace::Small().ModelFile(name);
        files[i].Set(sound[i]);
        std::filesystem::create_symlink(files[i].Path(), folder.Path() / name);
      }
    }
  };
  static Model model(extension);
  if (bytes.empty()) {
    return;
  }
  const size_t fuzzed = static_cast<uint8_t>(bytes[0]) % model.files.size();
  model.files[fuzzed].Set(bytes.substr(1));
  try {
    CandidateImageOrders(ReadSparseModel(model.folder.Path()));
  } catch (const FileError&) {
  }
  model.files[fuzzed].Set(model.sound[fuzzed]);
}

using Path = std::filesystem::path;
using Fuzz = std::function<void(const Path& path, std::string_view bytes)>;

const std::map<std::string, Fuzz> kFuzzers = {
    {"depth_map", [](const Path& path, auto) { ReadDepthMap(path); }},
    {"npy_mask", [](const Path& path, auto) { ReadNpyMask(path); }},
    {"picture_size",
     [](const Path& path, auto) {
       ReadPictureSize(path);
       IsPictureCutOff(path);
     }},
    {"ply_cloud", [](const Path& path, auto) { ReadPlyCloud(path); }},
    {"ply_mesh", [](const Path& path, auto) { ReadColoredPlyMesh(path); }},
    {"region", [](const Path& path, auto) { ReadRegion(path); }},
    {"sparse_model_binary",
     [](const Path&, std::string_view bytes) {
       FuzzSparseModel(".bin", bytes);
     }},
    {"sparse_model_text",
     [](const Path&, std::string_view bytes) {
       FuzzSparseModel(".txt", bytes);
     }},
    {"visibility", &FuzzVisibility}};

}  // namespace
}  // namespace colmap_ext

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  static colmap_ext::MemoryFile file;
  static const colmap_ext::Fuzz& fuzz =
      colmap_ext::kFuzzers.at(std::getenv("FUZZED"));
  const std::string_view text(reinterpret_cast<const char*>(bytes), num_bytes);
  file.Set(text);
  try {
    fuzz(file.Path(), text);
  } catch (const colmap_ext::FileError&) {
  }
  return 0;
}
