#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "colmap_ext/report/evaluation_report.h"
#include "colmap_ext/report/print_lines.h"

namespace colmap_ext {

namespace {

std::string Json(double number) {
  return std::isfinite(number) ? Format("%.9g", number) : "null";
}

std::string Json(size_t number) { return std::to_string(number); }

std::string Json(int64_t number) { return std::to_string(number); }

std::string Json(bool value) { return value ? "true" : "false"; }

std::string Json(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof(code), "\\u%04x", c);
      quoted += code;
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

// A JSON object, member by member.
class JsonObject {
 public:
  explicit JsonObject(int indent) : indent_(indent, ' ') {}

  JsonObject& Add(const char* name, const std::string& json) {
    members_ += (members_.empty() ? "\n" : ",\n") + indent_ + "  " +
                Json(std::string(name)) + ": " + json;
    return *this;
  }

  std::string Text() const { return "{" + members_ + "\n" + indent_ + "}"; }

 private:
  std::string indent_;
  std::string members_;
};

std::string Json(const DistanceStatistics& statistics) {
  return JsonObject(2)
      .Add("mean", Json(statistics.mean))
      .Add("median", Json(statistics.median))
      .Add("percentile90", Json(statistics.percentile90))
      .Add("num_samples", Json(statistics.num_samples))
      .Add("num_beyond", Json(statistics.num_beyond))
      .Text();
}

std::string Json(const std::vector<double>& numbers) {
  std::string list;
  for (const double number : numbers) {
    list += (list.empty() ? "" : ", ") + Json(number);
  }
  return "[" + list + "]";
}

std::string Json(const DepthErrors& depths) {
  std::vector<double> shares;
  for (size_t i = 0; i < depths.thresholds.size(); ++i) {
    shares.push_back(depths.Share(i));
  }
  return JsonObject(2)
      .Add("thresholds", Json(depths.thresholds))
      .Add("shares", Json(shares))
      .Add("num_depths", Json(depths.num_depths))
      .Add("num_missing", Json(depths.num_missing))
      .Text();
}

std::string Json(const MeshReport& mesh) {
  return JsonObject(2)
      .Add("is_manifold", Json(mesh.IsManifold()))
      .Add("defects", Json(mesh.Defects()))
      .Add("num_vertices", Json(mesh.num_vertices))
      .Add("num_faces", Json(mesh.num_facets))
      .Add("num_edges", Json(mesh.num_edges))
      .Add("num_components", Json(mesh.num_components))
      .Add("num_border_edges", Json(mesh.num_border_edges))
      .Add("num_border_loops", Json(mesh.num_border_loops))
      .Add("euler", Json(mesh.euler))
      .Add("genus", mesh.IsManifold() ? Json(mesh.genus) : "null")
      .Add("num_singular_vertices", Json(mesh.num_singular_vertices))
      .Add("num_non_manifold_edges", Json(mesh.num_non_manifold_edges))
      .Text();
}

}  // namespace

std::string EvaluationJson(const EvaluatorOptions& options,
                           const MeshEvaluation& evaluation) {
  JsonObject json(0);
  json.Add("mesh_path", Json(options.mesh_path))
      .Add("truth_path", Json(options.truth_path))
      .Add("workspace_path", Json(options.workspace_path))
      .Add("stride", Json(int64_t{options.evaluation.stride}))
      .Add("beyond",
           Json(std::string(options.evaluation.drop_beyond ? "dropped"
                                                           : "clipped")))
      .Add("num_images", Json(evaluation.num_views));
  if (const auto& distances = evaluation.distances) {
    json.Add("max_distance", Json(distances->max_distance))
        .Add("spacing", Json(distances->spacing))
        .Add("accuracy", Json(distances->accuracy))
        .Add("completeness", Json(distances->completeness))
        .Add("average_score", Json(distances->AverageScore()));
  } else {
    for (const char* name : {"max_distance", "spacing", "accuracy",
                             "completeness", "average_score"}) {
      json.Add(name, "null");
    }
  }
  if (evaluation.depths) {
    json.Add("depths", Json(*evaluation.depths));
  } else {
    json.Add("depths", "null");
  }
  return json.Add("topology", Json(evaluation.topology)).Text() + "\n";
}

}  // namespace colmap_ext
