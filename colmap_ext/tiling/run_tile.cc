#include "colmap_ext/tiling/run_tile.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/tiling/plan_files.h"
#include "formats/errors.h"
#include "meshing/finish_surface.h"
#include "tiles/merged_surface.h"
#include "tiles/singular_patch.h"

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

// The points of the surface's vertices. Centroids have none.
struct MergedPoints {
  PointCloud cloud;
  std::vector<uint32_t> vertex_points;
  std::vector<float> supports;
  std::vector<uint8_t> is_end;
};

MergedPoints PointsOf(const FilePlan& vertices, const MergedSurface& merged) {
  const auto end =
      std::ranges::lower_bound(merged.ids, vertices.Blocks().NumVertices());
  TileVertices read =
      vertices.ReadAttributes(std::vector<uint32_t>(merged.ids.begin(), end));
  MergedPoints points;
  points.cloud.positions.assign(
      merged.extracted.mesh.vertices.begin(),
      merged.extracted.mesh.vertices.begin() + (end - merged.ids.begin()));
  points.cloud.colors = std::move(read.colors);
  points.cloud.views = std::move(read.views);
  points.supports = std::move(read.supports);
  points.is_end = std::move(read.observations.is_end);
  points.vertex_points.resize(points.cloud.size());
  std::iota(points.vertex_points.begin(), points.vertex_points.end(), 0);
  return points;
}

SingularPatch Fix(const ManifoldMeshingOptions& options, const FilePlan& plan,
                  const FileParts& parts, const SeamLabels& seam,
                  const Progress& progress) {
  Report(progress, "Fixing singular vertices", 0);
  return options.preemptive_fixing
             ? FixPatches(plan, parts, seam, options.fixing_rule)
             : SingularPatch();
}

SeamLabels Cut(const Plan& plan, const FileParts& parts,
               const Progress& progress) {
  Report(progress, "Cutting the seams", 0);
  std::vector<TileSeam> seams;
  for (uint32_t tile = 0; tile < plan.tiles.size(); ++tile) {
    seams.push_back(parts.ReadSeam(tile));
  }
  return CutSeams(seams);
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
  for (uint32_t cell = 0; cell < cut.labels.size(); ++cell) {
    report.num_star_cells += cut.tile.IsStarCell(cell);
  }
  report.rays = cut.rays;
  return report;
}

ManifoldMesh MergePlan(const fs::path& folder, const Progress& progress,
                       MergeReport* report) {
  const Plan plan = ReadPlan(folder);
  ExpectSameInputs(plan);
  ManifoldMeshingOptions options = MeshingOptionsOf(folder, plan).meshing;
  options.region = plan.region;
  if (const auto found = plan.options.find("region");
      found != plan.options.end() && found->second == "auto") {
    report->found_region = plan.region;
  }
  const FilePlan vertices(folder, plan);
  const FileParts parts(folder, plan);
  report->num_tiles = plan.tiles.size();
  ManifoldMesh result;
  result.report.num_vertices = vertices.Blocks().NumVertices();
  result.report.distance_sigma = plan.distance_sigma;
  MergedSurface merged;
  {
    const SeamLabels seam = Cut(plan, parts, progress);
    report->num_cut_cells = seam.num_cut_cells;
    const SingularPatch patch = Fix(options, vertices, parts, seam, progress);
    result.report.fixing = patch.report;
    Report(progress, "Extracting the surface", 0);
    merged = MergeSurface(vertices, parts, seam, patch);
  }
  {
    const MergedPoints points = PointsOf(vertices, merged);
    std::vector<uint32_t>().swap(merged.ids);
    SplitSurface(
        options, std::move(merged.extracted),
        {points.cloud, points.vertex_points, points.supports, points.is_end},
        plan.views, &result);
  }
  FinishSurface(options, progress, &result);
  return result;
}

}  // namespace colmap_ext
