#include "colmap_ext/options/meshing_options.h"

#include "workspace/find_workspace.h"

namespace colmap_ext {

std::filesystem::path MesherOptions::InputPath() const {
  return workspace_path.empty() ? input_path : workspace_path;
}

std::filesystem::path MesherOptions::OutputPath(
    const std::filesystem::path& dense_path) const {
  return output_path.empty() ? dense_path / kMesherOutput
                             : std::filesystem::path(output_path);
}

std::string MesherOptions::Check() const {
  if (workspace_path.empty() == input_path.empty()) {
    return "either --workspace_path or --input_path is required";
  }
  if (!input_path.empty() && output_path.empty()) {
    return "--output_path is required with --input_path";
  }
  const std::string workspace_error = workspace.Check();
  return workspace_error.empty() ? meshing.Check() : workspace_error;
}

}  // namespace colmap_ext
