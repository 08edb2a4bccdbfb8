#include "colmap_ext/options/meshing_options.h"

#include <algorithm>
#include <cctype>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/image_order_option.h"
#include "colmap_ext/options/words.h"
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
  if (!plan_path.empty() || tile >= 0) {
    FinishTile();
    return;
  }
  if (workspace_path.empty() == input_path.empty()) {
    throw OptionError("either --workspace_path or --input_path is required");
  }
  if (!input_path.empty() && output_path.empty()) {
    throw OptionError("--output_path is required with --input_path");
  }
  if (!report_path.empty() &&
      std::filesystem::path(report_path).extension() != ".html") {
    throw OptionError("--report_path is a page, and ends in .html");
  }
  std::transform(words.input_type.begin(), words.input_type.end(),
                 words.input_type.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  workspace.fused_path = words.fused_path;
  workspace.input_type = ParseWord<InputType>(
      "input_type", words.input_type,
      {{"dense", InputType::kDense}, {"sparse", InputType::kSparse}});
  workspace.sparse_path = sparse_path;
  if (workspace.input_type == InputType::kSparse &&
      !workspace.fused_path.empty()) {
    throw OptionError("--fused_path is of dense input, not of sparse");
  }
  scene.Finish();
  if (mask_background && scene.mask_path.empty()) {
    throw OptionError("--mask_background needs --mask_path");
  }
  workspace.image_order = ParseImageOrder(words.image_order);
  meshing.alpha_kind = ParseWord<ObservationWeight>(
      "alpha_kind", words.alpha_kind,
      {{"tracks", ObservationWeight::kTracks},
       {"constant", ObservationWeight::kConstant}});
  meshing.fixing_rule = ParseWord<FixingRule>(
      "fixing_rule", words.fixing_rule,
      {{"energy", FixingRule::kEnergy}, {"paper", FixingRule::kPaper}});
}

void MesherOptions::FinishTile() const {
  if (plan_path.empty() || tile < 0) {
    throw OptionError("--plan and --tile belong together");
  }
  if (!InputPath().empty() || !output_path.empty() || !report_path.empty()) {
    throw OptionError(
        "--plan says what is meshed: leave out --workspace_path, --input_path, "
        "--output_path and --report_path");
  }
}

}  // namespace colmap_ext
