#include "colmap_ext/refinement_run.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan_refinement.h"
#include "colmap_ext/jobs/refinement_state.h"
#include "colmap_ext/jobs/resumable_refinement.h"
#include "colmap_ext/jobs/surface_files.h"
#include "colmap_ext/jobs/tile_job.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "formats/errors.h"

namespace colmap_ext {

namespace {

void PrintCommands(const RefinementPlan& plan, const std::string& folder) {
  std::cout << "\nOn Slurm, all at once:\n"
               "  scripts/slurm/refine_tiles "
            << folder << " REFINED.ply\nOn one machine, colour after colour:\n";
  for (uint32_t color = 0; color < plan.NumColors(); ++color) {
    std::cout << fmt::format(
        "  echo {} | xargs -n 1 -P 2 colmap facetwise_refiner --plan_path {} "
        "--tile\n",
        fmt::join(plan.TilesOf(color), " "), folder);
  }
  std::cout << fmt::format(
      "  colmap mesh_merger --plan_path {} --refined 1 --output_path "
      "REFINED.ply\n",
      folder);
}

void PrintPlan(const RefinementPlan& plan, const std::string& folder,
               ReportLog* log) {
  double memory = 0;
  double of_thread = 0;
  double seconds = 0;
  for (const RefinementTile& tile : plan.tiles) {
    memory = std::max(memory, tile.memory_gb);
    of_thread = std::max(of_thread, tile.thread_gb);
    seconds += tile.core_seconds;
  }
  PrintHeading("Refinement in tiles", log);
  Print("tiles", static_cast<int64_t>(plan.tiles.size()), log);
  Print("colours", plan.NumColors(), log);
  PrintText("memory, largest tile", fmt::format("{:.1f} GB", memory), log);
  PrintText("  and each thread", fmt::format("{:.2f} GB", of_thread), log);
  PrintText("time, all tiles",
            fmt::format("{:.2f} h of a core", seconds / 3600), log);
  PrintText("cameras", "as they are: tiles do not refine them", log);
  PrintCommands(plan, folder);
}

void PlanTiles(const RefinerOptions& options) {
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  RefinementPlanReport report;
  const RefinementPlan plan =
      PlanRefinement(options.plan_path, options.input_path, options,
                     reporter.AsProgress(), &report);
  reporter.Finish();
  if (report.is_kept) {
    std::cout << "This refinement is planned already: nothing to do"
              << std::endl;
  }
  ReportLog log(&std::cout);
  if (!report.is_locked) {
    PrintWarning(kNoLocks, &log);
  }
  PrintPlan(plan, options.plan_path, &log);
  PrintReport(reporter.StageTimes(), PeakMemory(), &log);
  std::cout << "\nPlanned " << RefinementPlanPath(options.plan_path).string()
            << std::endl;
}

void Print(const TileJob& job, const TileInput& tile, ReportLog* log) {
  PrintHeading("Tile", log);
  Print("colour", job.Color(job.tile), log);
  Print("images read", static_cast<int64_t>(tile.views.size()), log);
  if (tile.input.masks) {
    PrintReport(*tile.input.masks, log);
  }
  Print("faces read", static_cast<int64_t>(tile.part.mesh.facets.size()), log);
}

// A state that is damaged or of another run is ignored: the job starts from its
// first level then.
void ResumeIfPossible(ResumableRefinement* run, RefinementInput* input) {
  try {
    run->Resume(input);
  } catch (const FileError&) {
  }
}

// What the job makes of its tile.
// \throw Interruption if it is stopped
TilePatch MakeTile(const TileJob& job, const RefinerOptions& options,
                   ResumableRefinement* run) {
  TileInput tile =
      ReadTileInput(job, options, ColmapPictureDecoder(), run->GetProgress());
  run->Reporter()->Finish();
  Print(job, tile, run->Log());
  if (!tile.HasViews()) {
    return {};
  }
  run->inputs = tile.inputs;
  ResumeIfPossible(run, &tile.input);
  RefinedMesh refined = run->Run(&tile.input);
  run->Reporter()->Finish();
  if (refined.report.is_stopped) {
    throw Interruption(run->Signal(), run->Level() > 0
                                          ? "the tile is refined up to " +
                                                LevelName(run->Level()) +
                                                "; the next job goes on from it"
                                          : "the tile is not refined");
  }
  Print("self-intersections",
        static_cast<int64_t>(refined.report.num_self_intersections),
        run->Log());
  return MakePatch(job, tile, std::move(refined));
}

// Refines a tile, once: its file is complete or does not exist.
// \param options  how to compute; what to compute comes from the plan
void RefineTile(RefinerOptions options) {
  const TileJob job =
      MakeTileJob(options.plan_path, static_cast<uint32_t>(options.tile));
  const uint64_t identity = job.refinement.identity;
  job.refinement.SetOptions(job.folder, &options);
  options.FinishMethod();
  const std::filesystem::path output = PatchPath(job.folder, job.tile);
  if (HasPatch(job.folder, identity, job.tile)) {
    RemoveState(output);
    std::cout << "Tile " << job.tile << " is refined already: nothing to do"
              << std::endl;
    return;
  }
  ExpectRefined(job.folder, job.refinement, job.before);
  ResumableRefinement run(options, output, nullptr);
  const TilePatch patch = MakeTile(job, options, &run);
  WritePatch(job.folder, identity, job.tile, patch);
  RemoveState(output);
  Print("faces refined", static_cast<int64_t>(patch.removed.size()), run.Log());
  Print("faces that they become",
        static_cast<int64_t>(patch.part.mesh.facets.size()), run.Log());
  PrintReport(run.Reporter()->StageTimes(), PeakMemory(), run.Log());
  std::cout << "\nTile " << job.tile << " is refined" << std::endl;
}

}  // namespace

void RunTiledRefinement(const RefinerOptions& options) {
  if (options.tile >= 0) {
    RefineTile(options);
  } else {
    PlanTiles(options);
  }
}

}  // namespace colmap_ext
