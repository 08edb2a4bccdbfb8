#include "workspace/expect_outputs.h"

#include <string>
#include <system_error>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

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
