#include "colmap_ext/jobs/merge_plan.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/options/scene_options.h"
#include "formats/write_mesh.h"
#include "meshing/finish_surface.h"
#include "tiles/merged_plan.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// The cells of a plan, cut and fixed.
struct MergedCells {
  MergedCells(const FilePlan& vertices, const FileParts& parts)
      : seam(vertices, parts), changes(seam) {}

  SeamLabels seam;
  CellChanges changes;
};

std::unique_ptr<MergedCells> CutAndFix(const FilePlan& vertices,
                                       const FileParts& parts,
                                       const ManifoldMeshingOptions& options,
                                       int seam_rings, const Progress& progress,
                                       MergeReport* report) {
  auto cells = std::make_unique<MergedCells>(vertices, parts);
  report->num_contradictions = CutSeams(seam_rings, &cells->seam, progress);
  report->num_cut_cells = cells->seam.NumUnknown();
  if (options.preemptive_fixing) {
    report->meshing.fixing =
        FixPlan(options.fixing_rule, seam_rings == kAllAtOnce, &cells->changes,
                progress);
  }
  return cells;
}

// The whole surface, connected, where its cells are no longer needed.
MergedSurface Extract(const FilePlan& vertices, const FileParts& parts,
                      const ManifoldMeshingOptions& options, int seam_rings,
                      const Progress& progress, MergeReport* report) {
  const auto cells =
      CutAndFix(vertices, parts, options, seam_rings, progress, report);
  Report(progress, "Extracting the surface", 0);
  return MergeSurface(cells->changes);
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
  points.is_end = std::move(read.observations.is_end);
  SplitSurface(options, std::move(merged.extracted), std::move(points),
               plan.views, result);
}

}  // namespace

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
  FinishSurface(options, progress, &mesh);
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
