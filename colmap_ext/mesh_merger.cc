#include <filesystem>
#include <iostream>
#include <vector>

#include "colmap_ext/commands.h"
#include "colmap_ext/jobs/mesh_tiles.h"
#include "colmap_ext/jobs/refine_tiles.h"
#include "colmap_ext/jobs/resumable_refinement.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/run_command.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

void MergeRefinedTiles(const MergerOptions& options, Console* console) {
  const RefinedMesh refined =
      MergeRefined(options.plan_path, console->progress);
  Report(console->progress, "Writing the mesh", 0);
  ExpectManifold(refined.mesh);
  WriteMesh(options.output_path, refined.mesh, refined.attributes,
            options.transform);
  console->reporter.Finish();
  PrintReport(refined.report, Analyze(refined.mesh), &console->log);
}

// What a plan's folder has, but for meshes that were merged there before.
std::vector<fs::path> PlanInputs(const fs::path& folder) {
  std::vector<fs::path> inputs = {RefinedSparsePath(folder)};
  std::error_code ignored;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder, ignored)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".bin" || extension == ".json") {
      inputs.push_back(entry.path());
    }
  }
  return inputs;
}

void Merge(const MergerOptions& options, Console* console) {
  const fs::path& output = options.output_path;
  ExpectOutputs({output, VisibilityPath(output)},
                PlanInputs(options.plan_path));
  if (options.is_refined) {
    MergeRefinedTiles(options, console);
  } else {
    MergeTiles(options, console);
  }
  console->PrintTime();
  std::cout << "\nWrote " << output.string() << " and "
            << VisibilityPath(output).string();
  if (const auto sparse = RefinedSparsePath(options.plan_path);
      options.is_refined && std::filesystem::exists(sparse)) {
    std::cout << ", which belong to the cameras " << sparse.string();
  }
  std::cout << std::endl;
}

}  // namespace

int RunMeshMerger(int argc, char** argv) {
  return RunCommand(
      argc, argv, &AddMergerOptions, &Merge,
      {"a machine with more memory has to merge, or smaller tiles",
       "the plan's folder"});
}

}  // namespace colmap_ext
