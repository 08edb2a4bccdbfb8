#include "colmap_ext/jobs/mesh_tiles.h"

#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/plan_files.h"
#include "formats/write_mesh.h"
#include "meshing/finish_surface.h"
#include "tiles/merged_plan.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

struct MergeReport : ManifoldMeshingReport {
  size_t num_cut_cells = 0;  // at the seams
  // Arcs between cells on which two tiles differ (CutSeams).
  size_t num_contradictions = 0;
};

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
    report->fixing = FixPlan(options.fixing_rule, seam_rings == kAllAtOnce,
                             &changes, progress);
  }
  Report(progress, "Extracting the surface", 0);
  return MergeSurface(changes);
}

// What the vertices of the surface stand for.
// \param ids  MergedSurface
SurfacePoints PointsOf(const FilePlan& vertices, bool is_smoothed,
                       std::vector<uint32_t> ids) {
  // Centroids have no points.
  ids.erase(std::ranges::lower_bound(ids, vertices.Blocks().NumVertices()),
            ids.end());
  TileVertices read = vertices.ReadAttributes(ids);
  if (!is_smoothed) {
    read.noises.clear();
  }
  return {std::move(read.attributes), std::move(read.supports),
          std::move(read.noises), std::move(read.observations.is_end)};
}

void PrintTile(const TileCut& cut, const TileSeam& seam, ReportLog* log) {
  size_t num_star_cells = 0;
  for (uint32_t cell = 0; cell < cut.places.size(); ++cell) {
    num_star_cells += cut.tile.IsStarCell(cell);
  }
  PrintHeading("Tile", log);
  Print("vertices", cut.tile.num_own, log);
  Print("of other tiles, too", cut.tile.ids.size() - cut.tile.num_own, log);
  Print("rounds until none was missing", cut.tile.num_rounds, log);
  Print("cells", num_star_cells, log);
  Print("left to the merger", seam.unknown.size(), log);
  Print("rays walked", cut.rays.num_rays, log);
  PrintIfAny("rays given up", cut.rays.num_lost_rays, log);
}

}  // namespace

void MeshTile(const fs::path& folder, uint32_t tile, Console* console) {
  const Plan plan = ReadPlan(folder, tile);
  ExpectSame(plan);
  const JobFile cut_file = CutFile(plan, tile);
  if (cut_file.Exists()) {
    std::cout << "Tile " << tile << " is done already: nothing to do"
              << std::endl;
    return;
  }
  const PlannerOptions options = plan.Options();
  const ManifoldMeshingOptions& meshing = options.mesher.meshing;
  const FilePlan vertices(plan);
  std::vector<Eigen::Vector3d> centers;
  for (const View& view : plan.views) {
    centers.push_back(view.Center());
  }
  const TileCut cut = CutTile(vertices, tile, centers,
                              {{plan.distance_sigma, meshing.behind_sigma},
                               meshing.quality_regularization,
                               options.seam_rings},
                              console->progress);
  const TileSeam seam = SeamOf(cut);
  Report(console->progress, "Writing the tile", 0);
  Write(cut_file, cut, seam);
  console->reporter.Finish();
  PrintTile(cut, seam, &console->log);
  console->PrintTime();
  std::cout << "\nTile " << tile << " is done" << std::endl;
}

void MergeTiles(const MergerOptions& merger, Console* console) {
  const Progress& progress = console->progress;
  const Plan plan = ReadPlan(merger.plan_path);
  ExpectSame(plan);
  const PlannerOptions planner = plan.Options();
  ManifoldMeshingOptions options = planner.mesher.meshing;
  options.region = plan.region;
  MergeReport report;
  const FilePlan vertices(plan);
  const FileParts parts(plan);
  report.num_vertices = vertices.Blocks().NumVertices();
  report.distance_sigma = plan.distance_sigma;
  MergedSurface merged =
      Extract(vertices, parts, options, planner.seam_rings, progress, &report);
  ManifoldMesh mesh;
  mesh.report = report;
  Report(progress, "Splitting vertices", 0);
  SurfacePoints points =
      PointsOf(vertices, options.smoothing > 0, std::move(merged.ids));
  // As the mesher does without a plan.
  FinishSurface(options, std::move(merged.extracted), std::move(points),
                plan.views, progress, &mesh);
  Report(progress, "Writing the mesh", 0);
  AtomicFiles files;
  WriteMesh(merger.output_path, mesh.mesh, mesh.attributes, merger.transform,
            &files);
  planner.mesher.scene.region.WriteFound(plan.region, merger.output_path,
                                         &files);
  files.Commit();
  console->reporter.Finish();
  ReportLog* const log = &console->log;
  PrintHeading("Tiles", log);
  Print("tiles", plan.tiles.size(), log);
  Print("cells cut at the seams", report.num_cut_cells, log);
  PrintIfAny("arcs on which two tiles differ", report.num_contradictions, log);
  PrintReport(mesh.report, log);
}

}  // namespace colmap_ext
