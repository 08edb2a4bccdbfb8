#include <cmath>
#include <ostream>

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
               std::ostream& stream) {
  PrintText(label, Number(accuracy) + Number(completeness), stream);
}

void PrintPair(const char* label, size_t accuracy, size_t completeness,
               std::ostream& stream) {
  PrintText(label, fmt::format("{:14}{:14}", accuracy, completeness), stream);
}

void PrintDistances(const SurfaceDistances& distances, bool drop_beyond,
                    std::ostream& stream) {
  const DistanceStatistics& accuracy = distances.accuracy;
  const DistanceStatistics& completeness = distances.completeness;
  PrintHeading("Distances, scene units", stream);
  PrintText("", "      accuracy  completeness", stream);
  PrintPair("mean", accuracy.mean, completeness.mean, stream);
  PrintPair("median", accuracy.median, completeness.median, stream);
  PrintPair("90th percentile", accuracy.percentile90, completeness.percentile90,
            stream);
  PrintPair("samples", accuracy.num_samples, completeness.num_samples, stream);
  PrintPair(drop_beyond ? "  beyond the maximum, dropped"
                        : "  beyond the maximum, clipped",
            accuracy.num_beyond, completeness.num_beyond, stream);
  PrintText("average score", Number(distances.AverageScore()), stream);
  PrintText("maximum distance", Number(distances.max_distance), stream);
  PrintText("spacing of the samples", Number(distances.spacing), stream);
}

void PrintDepths(const DepthErrors& depths, std::ostream& stream) {
  PrintHeading("Depths", stream);
  for (size_t i = 0; i < depths.thresholds.size(); ++i) {
    PrintText(fmt::format("within {:.6g}", depths.thresholds[i]),
              std::isfinite(depths.Share(i))
                  ? fmt::format("{:12.2f} %", 100 * depths.Share(i))
                  : Number(depths.Share(i)),
              stream);
  }
  Print("true depths", static_cast<int64_t>(depths.num_depths), stream);
  Print("  without the mesh", static_cast<int64_t>(depths.num_missing), stream);
}

void PrintTopology(const MeshReport& mesh, std::ostream& stream) {
  PrintHeading("Mesh", stream);
  PrintText("2-manifold",
            mesh.IsManifold() ? "           yes" : "            no", stream);
  if (!mesh.IsManifold()) {
    PrintText("  defects", mesh.Defects(), stream);
  }
  Print("faces", static_cast<int64_t>(mesh.num_facets), stream);
  Print("vertices", static_cast<int64_t>(mesh.num_vertices), stream);
  Print("components", static_cast<int64_t>(mesh.num_components), stream);
  Print("border loops", static_cast<int64_t>(mesh.num_border_loops), stream);
  Print("border edges", static_cast<int64_t>(mesh.num_border_edges), stream);
  if (mesh.IsManifold()) {
    Print("genus", mesh.genus, stream);
  }
}

}  // namespace

void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, std::ostream& stream) {
  PrintTopology(evaluation.topology, stream);
  PrintIfAny("faces not finite, left out", evaluation.num_dropped_facets,
             stream);
  if (evaluation.num_views > 0) {
    PrintHeading("Seen by", stream);
    Print("images", static_cast<int64_t>(evaluation.num_views), stream);
    PrintIfAny("  without a true depth map",
               evaluation.num_views_without_depths, stream);
  }
  if (evaluation.distances) {
    PrintDistances(*evaluation.distances, options.evaluation.drop_beyond,
                   stream);
  }
  if (evaluation.depths) {
    PrintDepths(*evaluation.depths, stream);
  }
}

}  // namespace colmap_ext
