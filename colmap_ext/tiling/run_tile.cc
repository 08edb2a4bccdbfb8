#include "colmap_ext/tiling/run_tile.h"

#include <vector>

#include <fmt/format.h>

#include "colmap_ext/tiling/plan_files.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

TileCutOptions CutOptions(const Plan& plan,
                          const ManifoldMeshingOptions& meshing) {
  return {{plan.distance_sigma, meshing.behind_sigma},
          meshing.quality_regularization,
          plan.seam_rings};
}

std::vector<Eigen::Vector3d> CentersOf(const Plan& plan) {
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : plan.views) {
    centers.push_back(view.Center());
  }
  return centers;
}

}  // namespace

TileReport RunTile(const fs::path& folder, uint32_t tile,
                   const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  if (tile >= plan.tiles.size()) {
    throw FileError(PlanPath(folder),
                    fmt::format("has no tile {}, but those from 0 to {}", tile,
                                plan.tiles.size() - 1));
  }
  ExpectSameInputs(plan);
  TileReport report;
  if (HasCut(folder, plan.identity, tile)) {
    report.is_kept = true;
    return report;
  }
  const MesherOptions options = MeshingOptionsOf(folder, plan);
  const FilePlan vertices(folder, plan);
  const TileCut cut = CutTile(vertices, tile, CentersOf(plan),
                              CutOptions(plan, options.meshing), progress);
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
