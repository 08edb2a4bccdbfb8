#include "colmap_ext/tiling/describe_plan.h"

#include <fmt/format.h>

#include "colmap_ext/options/add_meshing_options.h"
#include "colmap_ext/refinement/file_fingerprint.h"

namespace colmap_ext {

namespace fs = std::filesystem;

Plan DescribePlan(const PlannerOptions& options, const FusedFiles& files) {
  Plan plan;
  const MesherOptions& mesher = options.mesher;
  plan.workspace_path = fs::absolute(mesher.workspace_path);
  const fs::path sparse = FindSparseFolder(
      mesher.sparse_path.empty()
          ? FindDenseFolder(mesher.InputPath(), mesher.workspace)
          : fs::path(mesher.sparse_path));
  for (const fs::path& input : {files.path, files.visibility_path}) {
    plan.inputs[fs::absolute(input).string()] = QuickFingerprint(input);
  }
  for (const auto& entry : fs::directory_iterator(sparse)) {
    plan.inputs[fs::absolute(entry.path()).string()] =
        QuickFingerprint(entry.path());
  }
  MesherOptions typed = mesher;
  CommandOptions command;
  AddMeshingOptions(&command, &typed);
  for (const CommandOptions::Option& option : command.Options()) {
    if (option.name != "DelaunayManifoldMeshing.num_threads") {
      plan.options[option.name] = option.default_value;
    }
  }
  plan.options["image_order"] = mesher.words.image_order;
  plan.options["mask_path"] = mesher.scene.mask_path;
  plan.options["mask_background"] = mesher.mask_background ? "1" : "0";
  plan.options["region"] = mesher.scene.region.text;
  if (const fs::path region = mesher.scene.region.text; fs::exists(region)) {
    plan.inputs[fs::absolute(region).string()] = QuickFingerprint(region);
  }
  plan.options["distance_sigma"] = fmt::format("{}", options.distance_sigma);
  plan.seam_rings = options.seam_rings;
  return plan;
}

}  // namespace colmap_ext
