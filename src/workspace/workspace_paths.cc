#include "workspace/workspace_paths.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "base/indices.h"
#include "formats/atomic_file.h"
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
  return std::ranges::any_of(files, [&](const std::string& file) {
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
  std::ranges::sort(found);
  return found;
}

bool IsSame(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) ||
         fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

// Whether writing the output would replace the input, or a file of it.
bool Replaces(const fs::path& output, const fs::path& input) {
  std::error_code ignored;
  if (!fs::is_directory(input, ignored)) {
    return IsSame(output, input);
  }
  const fs::path inner =
      fs::relative(fs::weakly_canonical(output, ignored), input, ignored);
  return fs::exists(output, ignored) && !inner.empty() &&
         *inner.begin() != "..";
}

}  // namespace

std::vector<fs::path> FindFoldersWith(const std::vector<std::string>& files,
                                      const fs::path& path) {
  ExpectFolder(path);
  if (HasAny(files, path)) {
    return {path};
  }
  std::vector<fs::path> found = SubfoldersWith(files, path);
  Append(SubfoldersWith(files, path / "dense"), &found);
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

void ExpectOutputs(const std::vector<fs::path>& outputs,
                   const std::vector<fs::path>& inputs) {
  for (size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) {
      continue;
    }
    ExpectWritable(outputs[i]);
    for (const fs::path& input : inputs) {
      if (!input.empty() && Replaces(outputs[i], input)) {
        throw FileError(outputs[i],
                        "it is read, and would be replaced; write elsewhere");
      }
    }
    for (size_t k = 0; k < i; ++k) {
      if (!outputs[k].empty() && IsSame(outputs[i], outputs[k])) {
        throw FileError(outputs[i], "two outputs would be this file");
      }
    }
  }
}

std::vector<fs::path> WorkspaceInputs(const fs::path& folder,
                                      const fs::path& fused,
                                      const fs::path& sparse) {
  const fs::path points = fused.empty() ? folder / "fused.ply" : fused;
  std::vector<fs::path> inputs = {folder / "images", folder / "stereo", points,
                                  points.string() + ".vis"};
  // Meshes may lie beside a model.
  const fs::path start = sparse.empty() ? folder : sparse;
  for (const char* model : {"", "sparse", "0", "sparse/0"}) {
    for (const char* name :
         {"cameras", "images", "points3D", "rigs", "frames"}) {
      for (const char* extension : {".bin", ".txt"}) {
        inputs.push_back(start / model / (std::string(name) + extension));
      }
    }
  }
  return inputs;
}

}  // namespace colmap_ext
