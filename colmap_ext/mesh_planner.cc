#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/mesh_tiles.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/terminal/terminal.h"

namespace colmap_ext {
namespace {

void PrintPlan(const Plan& plan, ReportLog* log) {
  PlannedTile all;
  double memory = 0;
  for (const PlannedTile& tile : plan.tiles) {
    all.num_points += tile.num_points;
    all.num_vertices += tile.num_vertices;
    all.num_rays += tile.num_rays;
    all.core_seconds += tile.core_seconds;
    memory = std::max(memory, tile.memory_gb);
  }
  PrintHeading("Plan", log);
  Print("tiles", plan.tiles.size(), log);
  Print("points", all.num_points, log);
  Print("vertices, after thinning", all.num_vertices, log);
  Print("rays", all.num_rays, log);
  PrintText("distance sigma", fmt::format("{:.4g}", plan.distance_sigma), log);
  PrintText("memory, largest tile", fmt::format("{:.1f} GB", memory), log);
  PrintText("memory, merger", fmt::format("{:.1f} GB", plan.merger_memory_gb),
            log);
  PrintText("time, all tiles",
            fmt::format("{:.2f} h of a core", all.core_seconds / 3600), log);
  const size_t last = plan.tiles.size() - 1;
  std::cout << fmt::format(
      "\nOn Slurm, both at once:\n  scripts/slurm/mesh_tiles {0} MESH.ply\n"
      "which queues\n"
      "  sbatch --array=0-{1} --mem={2}M scripts/slurm/tile.sbatch {0}\n"
      "  sbatch --dependency=afterok:... --mem={3}M "
      "scripts/slurm/merge.sbatch {0} MESH.ply\n"
      "On one machine:\n"
      "  seq 0 {1} | xargs -P 2 -I T {4} delaunay_manifold_mesher "
      "--plan_path {0} --tile T\n  {4} mesh_merger --plan_path {0} "
      "--output_path "
      "MESH.ply\n",
      InShell(plan.folder), last, static_cast<int>(1126 * memory) + 1,
      static_cast<int>(1126 * plan.merger_memory_gb) + 1, ProgramName());
}

void MakeAndPrint(const PlannerOptions& options, Console* console) {
  PlanReport report;
  const Plan plan =
      MakePlan(options, ColmapPictureDecoder(), console->progress, &report);
  console->reporter.Finish();
  ReportLog* const log = &console->log;
  if (!report.is_locked) {
    PrintWarning(kNoLocks, log);
  }
  if (report.is_kept) {
    std::cout << "This plan exists already: nothing to do" << std::endl;
  } else {
    PrintReport(report.workspace, plan.views.size(), report.half_pixel, log);
    PrintReport(report.masks, log);
    PrintReport(plan.region, log);
    PrintIfAny("points outside of the region", report.num_outside_points, log);
    PrintIfAny("points of weaker layers of walls", report.num_weaker_points,
               log);
    PrintIfAny("rays beyond", report.num_ray_ends, log);
  }
  PrintPlan(plan, log);
  console->PrintTime();
  std::cout << "\nPlanned " << options.output_path << std::endl;
}

}  // namespace

int RunMeshPlanner(int argc, char** argv) {
  return RunCommand(argc, argv, &AddPlannerOptions, &MakeAndPrint,
                    {"more tiles take less each: --num_tiles",
                     "fused.ply, fused.ply.vis and sparse/"});
}

}  // namespace colmap_ext
