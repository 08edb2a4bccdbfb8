#include "workspace/find_workspace.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/errors.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

void ExpectFolder(const fs::path& path) {
  if (!fs::exists(path)) {
    throw FileError(path, "no such folder");
  }
  if (!fs::is_directory(path)) {
    throw FileError(path, "not a folder");
  }
}

bool HasAny(const std::vector<std::string>& files, const fs::path& folder) {
  return std::any_of(files.begin(), files.end(), [&](const std::string& file) {
    return fs::exists(folder / file);
  });
}

std::vector<fs::path> SubfoldersWith(const std::vector<std::string>& files,
                                     const fs::path& folder) {
  std::vector<fs::path> found;
  if (fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.is_directory() && HasAny(files, entry.path())) {
        found.push_back(entry.path());
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

std::vector<fs::path> FindFoldersWith(const std::vector<std::string>& files,
                                      const fs::path& path) {
  ExpectFolder(path);
  if (HasAny(files, path)) {
    return {path};
  }
  std::vector<fs::path> found = SubfoldersWith(files, path);
  const std::vector<fs::path> deeper = SubfoldersWith(files, path / "dense");
  found.insert(found.end(), deeper.begin(), deeper.end());
  return found;
}

void ExpectOneFolder(const std::vector<fs::path>& found, const fs::path& path) {
  if (found.size() > 1) {
    std::string folders;
    for (const fs::path& folder : found) {
      folders += (folders.empty() ? "" : ", ") + folder.string();
    }
    throw FileError(path, fmt::format("which workspace? There are {}: {}",
                                      found.size(), folders));
  }
}

fs::path FindDenseFolder(const fs::path& path) {
  const std::vector<fs::path> found = FindFoldersWith({"fused.ply"}, path);
  if (found.empty()) {
    throw FileError(path,
                    "no fused.ply here nor in dense/ or dense/0/; run `colmap "
                    "stereo_fusion --workspace_path DIR --output_path "
                    "DIR/fused.ply` first");
  }
  ExpectOneFolder(found, path);
  return found[0];
}

fs::path FindUndistortedFolder(const fs::path& path) {
  const std::vector<fs::path> found =
      FindFoldersWith({"stereo", "fused.ply"}, path);
  ExpectOneFolder(found, path);
  return found.empty() ? path : found[0];
}

fs::path FindSparseFolder(const fs::path& path) {
  ExpectFolder(path);
  for (const fs::path& folder :
       {path / "sparse", path / "sparse" / "0", path}) {
    if (HasSparseModel(folder)) {
      return folder;
    }
  }
  throw FileError(path / "sparse",
                  "no sparse model: cameras, images and points3D, .bin or "
                  ".txt, are expected");
}

}  // namespace colmap_ext
