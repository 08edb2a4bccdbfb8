#include "colmap_ext/commands.h"

#include <algorithm>
#include <string>

#include "colmap_ext/dense_meshing.h"

namespace colmap_ext {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {
      {"delaunay_manifold_mesher", &RunDelaunayManifoldMesher,
       "mesh the fused points"},
      {"facetwise_refiner", &RunFacetwiseRefiner,
       "refine a mesh by the images"},
      {"mesh_evaluator", &RunMeshEvaluator,
       "measure a mesh against ground truth"},
      {"mesh_merger", &RunMeshMerger, "join the tiles of a plan"},
      {"mesh_planner", &RunMeshPlanner, "split a scene into tiles"},
      {"mesh_viewer", &RunMeshViewer, "show meshes, or draw pictures"},
  };
  return commands;
}

namespace {

// \pre the first argument is the name of a command
int RunByName(const std::vector<std::string>& arguments) {
  std::string program = "colmap";
  std::vector<std::string> texts(arguments.begin() + 1, arguments.end());
  std::vector<char*> argv = {program.data()};
  for (std::string& text : texts) {
    argv.push_back(text.data());
  }
  const auto command =
      std::ranges::find(Commands(), arguments[0], &Command::name);
  return command->run(static_cast<int>(argv.size()), argv.data());
}

}  // namespace

void EnableDenseMeshing() { GlobalDenseMeshing().run = &RunByName; }

}  // namespace colmap_ext
