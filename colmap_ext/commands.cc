#include "colmap_ext/commands.h"

namespace colmap_ext {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {
      {"delaunay_manifold_mesher", &RunDelaunayManifoldMesher},
      {"facetwise_refiner", &RunFacetwiseRefiner},
      {"mesh_evaluator", &RunMeshEvaluator},
  };
  return commands;
}

}  // namespace colmap_ext
