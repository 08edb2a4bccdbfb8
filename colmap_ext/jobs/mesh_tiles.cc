#include "colmap_ext/jobs/mesh_tiles.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/plan_files.h"
#include "formats/write_mesh.h"
#include "meshing/finish_surface.h"
#include "tiles/merged_plan.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// The whole surface, connected: the cells of a plan are cut, fixed, and no
// longer needed then.
MergedSurface Extract(const FilePlan& vertices, const FileParts& parts,
                      const ManifoldMeshingOptions& options, int seam_rings,
                      const Progress& progress, MergeReport* report) {
  SeamLabels seam(vertices, parts);
  CellChanges changes(seam);
  report->num_contradictions = CutSeams(seam_rings, &seam, progress);
  report->num_cut_cells = seam.NumUnknown();
  if (options.preemptive_fixing) {
    report->meshing.fixing = FixPlan(
        options.fixing_rule, seam_rings == kAllAtOnce, &changes, progress);
  }
  Report(progress, "Extracting the surface", 0);
  return MergeSurface(changes);
}

// Makes the surface a mesh, as the mesher does without a plan.
void Finish(const Plan& plan, const FilePlan& vertices,
            const ManifoldMeshingOptions& options, MergedSurface merged,
            const Progress& progress, ManifoldMesh* result) {
  Report(progress, "Splitting vertices", 0);
  std::vector<uint32_t> ids = std::move(merged.ids);
  // Centroids have no points.
  ids.erase(std::ranges::lower_bound(ids, vertices.Blocks().NumVertices()),
            ids.end());
  TileVertices read = vertices.ReadAttributes(ids);
  std::iota(ids.begin(), ids.end(), 0);
  SurfacePoints points;
  points.cloud.colors = std::move(read.colors);
  points.cloud.views = std::move(read.views);
  points.vertex_points = std::move(ids);
  points.supports = std::move(read.supports);
  if (options.smoothing > 0) {
    points.noises = std::move(read.noises);
  }
  points.is_end = std::move(read.observations.is_end);
  SplitSurface(options, std::move(merged.extracted), std::move(points),
               plan.views, result);
}

}  // namespace

TileReport RunTile(const fs::path& folder, uint32_t tile,
                   const Progress& progress) {
  const Plan plan = ReadPlan(folder, tile);
  ExpectSame(plan);
  TileReport report;
  const JobFile cut_file = CutFile(folder, plan.identity, tile);
  if (cut_file.Exists()) {
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
  Write(cut_file, cut, seam);
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

MergeReport MergePlan(const fs::path& folder, const fs::path& output_path,
                      const std::optional<Eigen::Matrix4d>& transform,
                      const Progress& progress) {
  const Plan plan = ReadPlan(folder);
  ExpectSame(plan);
  const PlannerOptions planner = plan.Options(folder);
  ManifoldMeshingOptions options = planner.mesher.meshing;
  options.region = plan.region;
  MergeReport report;
  const FilePlan vertices(folder, plan);
  const FileParts parts(folder, plan);
  report.num_tiles = plan.tiles.size();
  report.meshing.num_vertices = vertices.Blocks().NumVertices();
  report.meshing.distance_sigma = plan.distance_sigma;
  MergedSurface merged =
      Extract(vertices, parts, options, planner.seam_rings, progress, &report);
  ManifoldMesh mesh;
  mesh.report = report.meshing;
  Finish(plan, vertices, options, std::move(merged), progress, &mesh);
  FinishSurface(options, plan.views, progress, &mesh);
  report.meshing = mesh.report;
  Report(progress, "Writing the mesh", 0);
  AtomicFiles files;
  WriteMesh(output_path, mesh.mesh, mesh.attributes, transform, &files);
  WriteFoundRegion(planner.mesher.scene.region, plan.region, output_path,
                   &files);
  files.Commit();
  return report;
}

}  // namespace colmap_ext
