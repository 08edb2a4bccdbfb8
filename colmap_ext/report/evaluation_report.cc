
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "colmap_ext/report/print_report.h"

namespace colmap_ext {
namespace {

std::string Number(double number) {
  return std::isfinite(number) ? fmt::format("{:14.6g}", number)
                               : "             -";
}

std::string Number(size_t number) { return fmt::format("{:14}", number); }

void PrintDistances(const SurfaceDistances& distances, bool drop_beyond,
                    ReportLog* log) {
  const DistanceStatistics& accuracy = distances.accuracy;
  const DistanceStatistics& completeness = distances.completeness;
  PrintHeading("Distances, scene units", log);
  PrintText("", "      accuracy  completeness", log);
  const auto print = [&](const std::string& label, auto member) {
    PrintText(label, Number(accuracy.*member) + Number(completeness.*member),
              log);
  };
  print("mean", &DistanceStatistics::mean);
  print("median", &DistanceStatistics::median);
  print("90th percentile", &DistanceStatistics::percentile90);
  print("samples", &DistanceStatistics::num_samples);
  print(drop_beyond ? "  beyond the maximum, dropped"
                    : "  beyond the maximum, clipped",
        &DistanceStatistics::num_beyond);
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
  Print("true depths", depths.num_depths, log);
  Print("  without the mesh", depths.num_missing, log);
}

void PrintMesh(const MeshReport& mesh, ReportLog* log) {
  PrintHeading("Mesh", log);
  PrintText("2-manifold",
            mesh.IsManifold() ? "           yes" : "            no", log);
  if (!mesh.IsManifold()) {
    PrintText("  defects", mesh.Defects(), log);
  }
  PrintTopology(mesh, log);
}

using Json = nlohmann::ordered_json;

// Rounded to 9 significant digits; null if not finite.
Json ToJson(double number) {
  if (!std::isfinite(number)) {
    return nullptr;
  }
  return std::strtod(fmt::format("{:.9g}", number).c_str(), nullptr);
}

Json ToJson(const DistanceStatistics& statistics) {
  return {{"mean", ToJson(statistics.mean)},
          {"median", ToJson(statistics.median)},
          {"percentile90", ToJson(statistics.percentile90)},
          {"num_samples", statistics.num_samples},
          {"num_beyond", statistics.num_beyond}};
}

Json ToJson(const DepthErrors& depths) {
  Json thresholds = Json::array();
  Json shares = Json::array();
  for (size_t i = 0; i < depths.thresholds.size(); ++i) {
    thresholds.push_back(ToJson(depths.thresholds[i]));
    shares.push_back(ToJson(depths.Share(i)));
  }
  return {{"thresholds", thresholds},
          {"shares", shares},
          {"num_depths", depths.num_depths},
          {"num_missing", depths.num_missing}};
}

Json ToJson(const MeshReport& mesh) {
  return {{"is_manifold", mesh.IsManifold()},
          {"defects", mesh.Defects()},
          {"num_vertices", mesh.num_vertices},
          {"num_faces", mesh.num_facets},
          {"num_edges", mesh.num_edges},
          {"num_components", mesh.num_components},
          {"num_border_edges", mesh.num_border_edges},
          {"num_border_loops", mesh.num_border_loops},
          {"euler", mesh.euler},
          {"genus", mesh.IsManifold() ? Json(mesh.genus) : Json()},
          {"num_singular_vertices", mesh.num_singular_vertices},
          {"num_non_manifold_edges", mesh.num_non_manifold_edges}};
}

}  // namespace

void PrintEvaluation(const EvaluatorOptions& options,
                     const MeshEvaluation& evaluation, ReportLog* log) {
  PrintMesh(evaluation.topology, log);
  PrintIfAny("faces not finite, left out", evaluation.num_dropped_facets, log);
  if (evaluation.num_views > 0) {
    PrintHeading("Seen by", log);
    Print("images", evaluation.num_views, log);
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

std::string EvaluationJson(const EvaluatorOptions& options,
                           const MeshEvaluation& evaluation) {
  const auto& distances = evaluation.distances;
  const Json json = {
      {"mesh_path", options.mesh_path},
      {"truth_path", options.truth_path},
      {"workspace_path", options.workspace_path},
      {"stride", options.evaluation.stride},
      {"beyond", options.evaluation.drop_beyond ? "dropped" : "clipped"},
      {"num_images", evaluation.num_views},
      {"max_distance", distances ? ToJson(distances->max_distance) : Json()},
      {"spacing", distances ? ToJson(distances->spacing) : Json()},
      {"accuracy", distances ? ToJson(distances->accuracy) : Json()},
      {"completeness", distances ? ToJson(distances->completeness) : Json()},
      {"average_score", distances ? ToJson(distances->AverageScore()) : Json()},
      {"depths", evaluation.depths ? ToJson(*evaluation.depths) : Json()},
      {"topology", ToJson(evaluation.topology)}};
  // Names of files may be in any encoding.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace colmap_ext
