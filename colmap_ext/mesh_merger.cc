#include <unistd.h>

#include <iostream>
#include <string>

#include "colmap_ext/commands.h"
#include "colmap_ext/jobs/merge_plan.h"
#include "colmap_ext/jobs/refinement_state.h"
#include "colmap_ext/options/tiling_options.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "formats/atomic_file.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"

namespace colmap_ext {

namespace {

CommandAdvice Advice() {
  return {"a machine with more memory has to merge, or smaller tiles",
          "the plan's folder",
          {}};
}

void MergeRefinedTiles(const MergerOptions& options) {
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  const Progress progress = reporter.AsProgress();
  const RefinedMesh refined = MergeRefined(options.plan_path, progress);
  Report(progress, "Writing the mesh", 0);
  ExpectManifold(refined.mesh);
  WriteMesh(options.output_path, refined.mesh, refined.attributes,
            options.transform);
  reporter.Finish();
  ReportLog log(&std::cout);
  PrintReport(refined.report, Analyze(refined.mesh), &log);
  PrintReport(reporter.StageTimes(), PeakMemory(), &log);
}

void MergeTiles(const MergerOptions& options) {
  ProgressReporter reporter(std::cout, isatty(STDOUT_FILENO) != 0);
  const Progress progress = reporter.AsProgress();
  const MergeReport report = MergePlan(options.plan_path, options.output_path,
                                       options.transform, progress);
  reporter.Finish();
  ReportLog log(&std::cout);
  PrintHeading("Tiles", &log);
  Print("tiles", static_cast<int64_t>(report.num_tiles), &log);
  Print("cells cut at the seams", static_cast<int64_t>(report.num_cut_cells),
        &log);
  if (report.num_contradictions > 0) {
    Print("arcs that two tiles tell differently",
          static_cast<int64_t>(report.num_contradictions), &log);
  }
  PrintReport(report.meshing, &log);
  PrintReport(reporter.StageTimes(), PeakMemory(), &log);
}

void Merge(const MergerOptions& options) {
  ReturnBlocksFrom(1 << 22);
  ExpectWritable(options.output_path);
  ExpectWritable(VisibilityPath(options.output_path));
  if (options.is_refined) {
    MergeRefinedTiles(options);
  } else {
    MergeTiles(options);
  }
  std::cout << "\nWrote " << options.output_path << " and "
            << VisibilityPath(options.output_path).string() << std::endl;
}

}  // namespace

int RunMeshMerger(int argc, char** argv) {
  MergerOptions options;
  CommandOptions command;
  AddMergerOptions(&command, &options);
  const CommandSteps steps = {[&options] { options.Finish(); },
                              &options.num_threads,
                              [&options] { Merge(options); }};
  return RunCommand(argc, argv, command, steps, Advice());
}

}  // namespace colmap_ext
