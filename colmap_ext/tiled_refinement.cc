#include "colmap_ext/tiled_refinement.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/jobs/refine_tiles.h"
#include "colmap_ext/jobs/resumable_refinement.h"

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
  Print("tiles", plan.tiles.size(), log);
  Print("colours", plan.NumColors(), log);
  PrintText("memory, largest tile", fmt::format("{:.1f} GB", memory), log);
  PrintText("  and each thread", fmt::format("{:.2f} GB", of_thread), log);
  PrintText("time, all tiles",
            fmt::format("{:.2f} h of a core", seconds / 3600), log);
  PrintText("cameras", "as they are: tiles do not refine them", log);
  PrintCommands(plan, folder);
}

void PlanTiles(const RefinerOptions& options, Console* console) {
  RefinementPlanReport report;
  const RefinementPlan plan =
      PlanRefinement(options.plan_path, options.input_path, options,
                     console->progress, &report);
  console->reporter.Finish();
  if (report.is_kept) {
    std::cout << "This refinement is planned already: nothing to do"
              << std::endl;
  }
  if (!report.is_locked) {
    PrintWarning(kNoLocks, &console->log);
  }
  PrintPlan(plan, options.plan_path, &console->log);
  console->PrintTime();
  std::cout << "\nPlanned " << RefinementPlanPath(options.plan_path).string()
            << std::endl;
}

void Print(const TileJob& job, const TileInput& tile, ReportLog* log) {
  PrintHeading("Tile", log);
  Print("colour", job.Color(job.tile), log);
  Print("images read", tile.views.size(), log);
  if (tile.input.masks) {
    PrintReport(*tile.input.masks, log);
  }
  Print("faces read", tile.part.mesh.facets.size(), log);
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
                   Console* console, ResumableRefinement* run) {
  TileInput tile =
      ReadTileInput(job, options, ColmapPictureDecoder(), console->progress);
  console->reporter.Finish();
  Print(job, tile, &console->log);
  if (!tile.HasViews()) {
    return {};
  }
  run->inputs = tile.inputs;
  ResumeIfPossible(run, &tile.input);
  RefinedMesh refined = run->Run(&tile.input);
  console->reporter.Finish();
  if (refined.report.is_stopped) {
    throw Interruption(run->Signal(), run->Level() > 0
                                          ? "the tile is refined up to " +
                                                LevelName(run->Level()) +
                                                "; the next job goes on from it"
                                          : "the tile is not refined");
  }
  Print("self-intersections", refined.report.num_self_intersections,
        &console->log);
  return MakePatch(job, tile, std::move(refined));
}

// Refines a tile, once: its file is complete or does not exist.
// \param options  how to compute; what to compute comes from the plan
void RefineTile(RefinerOptions options, Console* console) {
  const TileJob job =
      MakeTileJob(options.plan_path, static_cast<uint32_t>(options.tile));
  job.refinement.SetOptions(job.folder, &options);
  options.FinishMethod();
  const JobFile patch_file =
      PatchFile(job.folder, job.refinement.identity, job.tile);
  if (patch_file.Exists()) {
    RemoveState(patch_file.path);
    std::cout << "Tile " << job.tile << " is refined already: nothing to do"
              << std::endl;
    return;
  }
  ExpectRefined(job.folder, job.refinement, job.before);
  ResumableRefinement run(options, patch_file.path, console, nullptr);
  const TilePatch patch = MakeTile(job, options, console, &run);
  Write(patch_file, patch);
  RemoveState(patch_file.path);
  Print("faces refined", patch.removed.size(), &console->log);
  Print("faces that they become", patch.part.mesh.facets.size(), &console->log);
  console->PrintTime();
  std::cout << "\nTile " << job.tile << " is refined" << std::endl;
}

}  // namespace

void RunTiledRefinement(const RefinerOptions& options, Console* console) {
  if (options.tile >= 0) {
    RefineTile(options, console);
  } else {
    PlanTiles(options, console);
  }
}

}  // namespace colmap_ext
