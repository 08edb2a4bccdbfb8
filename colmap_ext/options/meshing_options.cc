#include "colmap_ext/options/meshing_options.h"

#include "colmap_ext/options/words.h"
#include "formats/errors.h"
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

void MesherOptions::Finish() {
  if (workspace_path.empty() == input_path.empty()) {
    throw OptionError("either --workspace_path or --input_path is required");
  }
  if (!input_path.empty() && output_path.empty()) {
    throw OptionError("--output_path is required with --input_path");
  }
  if (const std::string error = workspace.Check(); !error.empty()) {
    throw OptionError(error);
  }
  meshing.alpha_kind =
      IsSecondWord("alpha_kind", alpha_kind, "tracks", "constant")
          ? ObservationWeight::kConstant
          : ObservationWeight::kTracks;
  meshing.fixing_rule =
      IsSecondWord("fixing_rule", fixing_rule, "energy", "paper")
          ? FixingRule::kPaper
          : FixingRule::kEnergy;
  CheckNumThreads(num_threads);
  if (const std::string error = meshing.Check(); !error.empty()) {
    throw OptionError("DelaunayManifoldMeshing." + error);
  }
}

}  // namespace colmap_ext
