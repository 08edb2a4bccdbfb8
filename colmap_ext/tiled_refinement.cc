#include "colmap_ext/tiled_refinement.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan_refinement.h"
#include "colmap_ext/jobs/refine_tile.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "colmap_ext/terminal/stop_signal.h"

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

void Print(const RefineTileReport& report, ReportLog* log) {
  PrintHeading("Tile", log);
  Print("colour", report.color, log);
  if (report.resumed_level > 0) {
    PrintText("went on after", LevelName(report.resumed_level), log);
  }
  Print("images read", static_cast<int64_t>(report.num_views), log);
  if (report.masks) {
    PrintReport(*report.masks, log);
  }
  Print("faces read", static_cast<int64_t>(report.num_facets), log);
  Print("faces refined", static_cast<int64_t>(report.num_removed), log);
  Print("faces that they become", static_cast<int64_t>(report.num_added), log);
  Print("self-intersections",
        static_cast<int64_t>(report.refinement.num_self_intersections), log);
  PrintText("computed by", report.computed_by, log);
  for (const std::string& warning : report.warnings) {
    PrintWarning(warning, log);
  }
}

void RefineOne(const RefinerOptions& options) {
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  const StopSignal stop_signal;
  RefinementHooks hooks;
  hooks.progress = reporter.AsProgress();
  hooks.on_step = [&reporter](const RefinementStep& step, const RefinedMesh&) {
    reporter.Note(Describe(step));
  };
  hooks.should_stop = [] { return StopSignal::Received() != 0; };
  const RefineTileReport report =
      RefineTile(options.plan_path, static_cast<uint32_t>(options.tile),
                 options, ColmapPictureDecoder(), hooks);
  reporter.Finish();
  if (report.refinement.is_stopped) {
    throw Interruption(StopSignal::Received(),
                       report.last_level > 0
                           ? "the tile is refined up to " +
                                 LevelName(report.last_level) +
                                 "; the next job goes on from it"
                           : "the tile is not refined");
  }
  if (report.is_kept) {
    std::cout << "Tile " << options.tile << " is refined already: nothing to do"
              << std::endl;
    return;
  }
  ReportLog log(&std::cout);
  Print(report, &log);
  PrintReport(reporter.StageTimes(), PeakMemory(), &log);
  std::cout << "\nTile " << options.tile << " is refined" << std::endl;
}

}  // namespace

void RunTiledRefinement(const RefinerOptions& options) {
  if (options.tile >= 0) {
    RefineOne(options);
  } else {
    PlanTiles(options);
  }
}

}  // namespace colmap_ext
