#include "colmap_ext/tiling/describe_plan.h"

#include <map>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "colmap_ext/options/add_meshing_options.h"
#include "colmap_ext/refinement/file_fingerprint.h"

namespace colmap_ext {

namespace fs = std::filesystem;

namespace {

// Of all masks together: jobs that mesh a tile do not read them, and need not
// look at each, as they do at Plan::inputs.
std::string FingerprintOf(const fs::path& masks) {
  std::map<std::string, std::string> files;
  std::error_code ignored;  // the planner says what is wrong with the folder
  for (const auto& file : fs::recursive_directory_iterator(masks, ignored)) {
    files[file.path().string()] = QuickFingerprint(file.path());
  }
  uint64_t hash = HashBytes("");
  for (const auto& [path, fingerprint] : files) {
    hash = HashBytes(fmt::format("{}={}\n", path, fingerprint), hash);
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace

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
  const fs::path masks = mesher.scene.mask_path;  // jobs may run elsewhere
  plan.options["mask_path"] = masks.empty() ? "" : fs::absolute(masks).string();
  if (!masks.empty()) {
    plan.options["masks"] = FingerprintOf(fs::absolute(masks));
  }
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
