#include "colmap_ext/jobs/run_tile.h"

#include <vector>

#include "colmap_ext/jobs/plan_files.h"

namespace colmap_ext {

namespace fs = std::filesystem;

TileReport RunTile(const fs::path& folder, uint32_t tile,
                   const Progress& progress) {
  const Plan plan = ReadPlan(folder, tile);
  ExpectSame(plan);
  TileReport report;
  if (HasCut(folder, plan.identity, tile)) {
    report.is_kept = true;
    return report;
  }
  const PlannerOptions options = plan.Options(folder);
  const ManifoldMeshingOptions& meshing = options.mesher.meshing;
  const FilePlan vertices(folder, plan);
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : plan.views) {
    centers.push_back(view.Center());
  }
  const TileCut cut = CutTile(vertices, tile, centers,
                              {{plan.distance_sigma, meshing.behind_sigma},
                               meshing.quality_regularization,
                               options.seam_rings},
                              progress);
  const TileSeam seam = SeamOf(cut);
  Report(progress, "Writing the tile", 0);
  WriteCut(folder, plan.identity, tile, cut, seam);
  report.num_vertices = cut.tile.num_own;
  report.num_other_vertices = cut.tile.ids.size() - cut.tile.num_own;
  report.num_rounds = cut.tile.num_rounds;
  report.num_unknown_cells = seam.unknown.size();
  for (uint32_t cell = 0; cell < cut.places.size(); ++cell) {
    report.num_star_cells += cut.tile.IsStarCell(cell);
  }
  report.rays = cut.rays;
  return report;
}

}  // namespace colmap_ext
