#include <cmath>

#include <fmt/format.h>

#include "colmap_ext/report/evaluation_report.h"
#include "colmap_ext/report/print_lines.h"

namespace colmap_ext {

namespace {

std::string Number(double number) {
  return std::isfinite(number) ? fmt::format("{:14.6g}", number)
                               : "             -";
}

void PrintPair(const char* label, double accuracy, double completeness,
               ReportLog* log) {
  PrintText(label, Number(accuracy) + Number(completeness), log);
}

void PrintPair(const char* label, size_t accuracy, size_t completeness,
               ReportLog* log) {
  PrintText(label, fmt::format("{:14}{:14}", accuracy, completeness), log);
}

void PrintDistances(const SurfaceDistances& distances, bool drop_beyond,
                    ReportLog* log) {
  const DistanceStatistics& accuracy = distances.accuracy;
  const DistanceStatistics& completeness = distances.completeness;
  PrintHeading("Distances, scene units", log);
  PrintText("", "      accuracy  completeness", log);
  PrintPair("mean", accuracy.mean, completeness.mean, log);
  PrintPair("median", accuracy.median, completeness.median, log);
  PrintPair("90th percentile", accuracy.percentile90, completeness.percentile90,
            log);
  PrintPair("samples", accuracy.num_samples, completeness.num_samples, log);
  PrintPair(drop_beyond ? "  beyond the maximum, dropped"
                        : "  beyond the maximum, clipped",
            accuracy.num_beyond, completeness.num_beyond, log);
  PrintText("average score", Number(distances.AverageScore()), log);
  PrintText("maximum distance", Number(distances.max_distance), log);
  PrintText("spacing of the samples", Number(distances.spacing), log);
}

void PrintDepths(const DepthErrors& depths, ReportLog* log) {
  PrintHeading("Depths", log);
  for (size_t i = 0; i < depths.thresholds.size(); ++i) {
    PrintText(fmt::format("within {:.6g}", depths.thresholds[i]),
              std::isfinite(depths.Share(i))
                  ? fmt::format("{:12.2f} %", 100 * depths.Share(i))
                  : Number(depths.Share(i)),
              log);
  }
  Print("true depths", static_cast<int64_t>(depths.num_depths), log);
  Print("  without the mesh", static_cast<int64_t>(depths.num_missing), log);
}

void PrintTopology(const MeshReport& mesh, ReportLog* log) {
  PrintHeading("Mesh", log);
  PrintText("2-manifold",
            mesh.IsManifold() ? "           yes" : "            no", log);
  if (!mesh.IsManifold()) {
    PrintText("  defects", mesh.Defects(), log);
  }
  Print("faces", static_cast<int64_t>(mesh.num_facets), log);
  Print("vertices", static_cast<int64_t>(mesh.num_vertices), log);
  Print("components", static_cast<int64_t>(mesh.num_components), log);
  Print("border loops", static_cast<int64_t>(mesh.num_border_loops), log);
  Print("border edges", static_cast<int64_t>(mesh.num_border_edges), log);
  if (mesh.IsManifold()) {
    Print("genus", mesh.genus, log);
  }
}

}  // namespace

void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, ReportLog* log) {
  PrintTopology(evaluation.topology, log);
  PrintIfAny("faces not finite, left out", evaluation.num_dropped_facets, log);
  if (evaluation.num_views > 0) {
    PrintHeading("Seen by", log);
    Print("images", static_cast<int64_t>(evaluation.num_views), log);
    PrintIfAny("  without a true depth map",
               evaluation.num_views_without_depths, log);
  }
  if (evaluation.distances) {
    PrintDistances(*evaluation.distances, options.evaluation.drop_beyond, log);
  }
  if (evaluation.depths) {
    PrintDepths(*evaluation.depths, log);
  }
}

}  // namespace colmap_ext
