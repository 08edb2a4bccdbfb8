#include "colmap_ext/refinement/resume_file.h"

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "formats/errors.h"

namespace colmap_ext {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "colmap_ext facetwise_refiner resume";
constexpr int kVersion = 6;

// Objects in lists in the top object. Deeper values are dropped unread, so that
// no nesting takes memory.
constexpr int kMaxDepth = 3;

// Thrown and caught here.
struct Damage {};

// Numbers that are not finite have no form in JSON; they become words.
Json NumberToJson(double number) {
  if (std::isfinite(number)) {
    return number;
  }
  return std::isnan(number) ? "nan" : number > 0 ? "inf" : "-inf";
}

const Json& Member(const Json& object, const char* name) {
  const auto it = object.find(name);
  if (it == object.end()) {
    throw Damage();
  }
  return *it;
}

std::string Text(const Json& object, const char* name) {
  const Json& value = Member(object, name);
  if (!value.is_string()) {
    throw Damage();
  }
  return value.get<std::string>();
}

double Number(const Json& object, const char* name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Json& value = Member(object, name);
  if (value.is_number()) {
    return value.get<double>();
  }
  const std::string word = Text(object, name);
  if (word == "nan") {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (word != "inf" && word != "-inf") {
    throw Damage();
  }
  return word == "inf" ? kInfinity : -kInfinity;
}

template <std::integral T>
T Count(const Json& object, const char* name) {
  const Json& value = Member(object, name);
  if (!value.is_number_unsigned()) {
    throw Damage();
  }
  const auto count = value.get<uint64_t>();
  if (count > static_cast<uint64_t>(std::numeric_limits<T>::max())) {
    throw Damage();
  }
  return static_cast<T>(count);
}

bool Flag(const Json& object, const char* name) {
  const Json& value = Member(object, name);
  if (!value.is_boolean()) {
    throw Damage();
  }
  return value.get<bool>();
}

const Json& List(const Json& object, const char* name) {
  const Json& value = Member(object, name);
  if (!value.is_array()) {
    throw Damage();
  }
  return value;
}

Json ToJson(const LabelingReport& labeling) {
  return {{"level", labeling.level},
          {"num_pairs", labeling.num_pairs},
          {"num_unlabeled_facets", labeling.num_unlabeled_facets},
          {"initial_energy", NumberToJson(labeling.initial_energy)},
          {"final_energy", NumberToJson(labeling.final_energy)},
          {"lower_bound", NumberToJson(labeling.lower_bound)}};
}

LabelingReport ToLabeling(const Json& json) {
  LabelingReport labeling;
  labeling.level = Count<int>(json, "level");
  labeling.num_pairs = Count<size_t>(json, "num_pairs");
  labeling.num_unlabeled_facets = Count<size_t>(json, "num_unlabeled_facets");
  labeling.initial_energy = Number(json, "initial_energy");
  labeling.final_energy = Number(json, "final_energy");
  labeling.lower_bound = Number(json, "lower_bound");
  return labeling;
}

Json ToJson(const RefinementStep& step) {
  return {{"level", step.level},
          {"is_final", step.is_final},
          {"num_pairs", step.num_pairs},
          {"iteration", step.iteration},
          {"energy", NumberToJson(step.energy)},
          {"photometric_energy", NumberToJson(step.photometric_energy)},
          {"mean_zncc", NumberToJson(step.mean_zncc)},
          {"mean_step", NumberToJson(step.mean_step)},
          {"seconds", NumberToJson(step.seconds)},
          {"num_vertices", step.num_vertices},
          {"num_facets", step.num_facets}};
}

RefinementStep ToStep(const Json& json) {
  RefinementStep step;
  step.level = Count<int>(json, "level");
  step.is_final = Flag(json, "is_final");
  step.num_pairs = Count<size_t>(json, "num_pairs");
  step.iteration = Count<int>(json, "iteration");
  step.energy = Number(json, "energy");
  step.photometric_energy = Number(json, "photometric_energy");
  step.mean_zncc = Number(json, "mean_zncc");
  step.mean_step = Number(json, "mean_step");
  step.seconds = Number(json, "seconds");
  step.num_vertices = Count<size_t>(json, "num_vertices");
  step.num_facets = Count<size_t>(json, "num_facets");
  return step;
}

Json ToJson(const std::optional<Misalignment>& misalignment) {
  if (!misalignment) {
    return nullptr;
  }
  return {{"by_cameras", misalignment->by_cameras},
          {"of_surface", misalignment->of_surface},
          {"by_view", misalignment->by_view}};
}

std::optional<Misalignment> ToMisalignment(const Json& json) {
  if (json.is_null()) {
    return std::nullopt;
  }
  Misalignment misalignment;
  misalignment.by_cameras = Number(json, "by_cameras");
  misalignment.of_surface = Number(json, "of_surface");
  for (const Json& value : List(json, "by_view")) {
    if (!value.is_number()) {
      throw Damage();
    }
    misalignment.by_view.push_back(value.get<double>());
  }
  return misalignment;
}

RunIdentity ToIdentity(const Json& json) {
  RunIdentity identity;
  for (const Json& pair : json) {
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() ||
        !pair[1].is_string()) {
      throw Damage();
    }
    identity.emplace_back(pair[0].get<std::string>(),
                          pair[1].get<std::string>());
  }
  return identity;
}

CameraNumbers ToCameraNumbers(const Json& json) {
  CameraNumbers numbers;
  if (!json.is_array() || json.size() != numbers.size()) {
    throw Damage();
  }
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (!json[i].is_number()) {
      throw Damage();
    }
    numbers[i] = json[i].get<double>();
  }
  return numbers;
}

ResumeRecord ToRecord(const Json& json) {
  if (!json.is_object() || Text(json, "format") != kFormat ||
      Count<int>(json, "version") != kVersion) {
    throw Damage();
  }
  ResumeRecord record;
  record.identity = ToIdentity(List(json, "identity"));
  record.level = Count<int>(json, "level");
  if (record.level < 1) {
    throw Damage();
  }
  record.mesh = Text(json, "mesh");
  record.visibility = Text(json, "visibility");
  record.origins = Text(json, "origins");
  record.fixed = Text(json, "fixed");
  for (const Json& camera : List(json, "cameras")) {
    record.cameras.push_back(ToCameraNumbers(camera));
  }
  record.report.misalignment = ToMisalignment(Member(json, "misalignment"));
  record.report.num_shortened_steps = Count<size_t>(json, "shortened_steps");
  record.report.num_unconverged_solutions =
      Count<size_t>(json, "unconverged_solutions");
  record.report.num_flipped_facets = Count<size_t>(json, "flipped_facets");
  record.report.num_removed_self_intersections =
      Count<size_t>(json, "removed_self_intersections");
  for (const Json& labeling : List(json, "labelings")) {
    record.report.labelings.push_back(ToLabeling(labeling));
  }
  for (const Json& step : List(json, "steps")) {
    record.report.steps.push_back(ToStep(step));
  }
  return record;
}

}  // namespace

std::vector<CameraNumbers> CameraNumbersOf(const std::vector<View>& views) {
  std::vector<CameraNumbers> all;
  for (const View& view : views) {
    const Eigen::Matrix3d& r = view.cam_from_world_rotation;
    const Eigen::Vector3d& t = view.cam_from_world_translation;
    all.push_back({view.fx, view.fy, view.cx, view.cy,  //
                   r(0, 0), r(0, 1), r(0, 2),           //
                   r(1, 0), r(1, 1), r(1, 2),           //
                   r(2, 0), r(2, 1), r(2, 2), t[0], t[1], t[2]});
  }
  return all;
}

std::vector<View> WithCameraNumbers(std::vector<View> views,
                                    const std::vector<CameraNumbers>& numbers) {
  for (size_t i = 0; i < views.size(); ++i) {
    const CameraNumbers& n = numbers[i];
    views[i].fx = n[0];
    views[i].fy = n[1];
    views[i].cx = n[2];
    views[i].cy = n[3];
    views[i].cam_from_world_rotation << n[4], n[5], n[6],  //
        n[7], n[8], n[9],                                  //
        n[10], n[11], n[12];
    views[i].cam_from_world_translation << n[13], n[14], n[15];
  }
  return views;
}

std::string ResumeText(const ResumeRecord& record) {
  Json json = {{"format", kFormat}, {"version", kVersion}};
  Json& identity = json["identity"] = Json::array();
  for (const auto& [name, value] : record.identity) {
    identity.push_back(Json::array({name, value}));
  }
  json["level"] = record.level;
  json["mesh"] = record.mesh;
  json["visibility"] = record.visibility;
  json["origins"] = record.origins;
  json["fixed"] = record.fixed;
  Json& cameras = json["cameras"] = Json::array();
  for (const CameraNumbers& numbers : record.cameras) {
    cameras.push_back(numbers);
  }
  json["misalignment"] = ToJson(record.report.misalignment);
  json["shortened_steps"] = record.report.num_shortened_steps;
  json["unconverged_solutions"] = record.report.num_unconverged_solutions;
  json["flipped_facets"] = record.report.num_flipped_facets;
  json["removed_self_intersections"] =
      record.report.num_removed_self_intersections;
  Json& labelings = json["labelings"] = Json::array();
  for (const LabelingReport& labeling : record.report.labelings) {
    labelings.push_back(ToJson(labeling));
  }
  Json& steps = json["steps"] = Json::array();
  for (const RefinementStep& step : record.report.steps) {
    steps.push_back(ToJson(step));
  }
  // Names of files may be in any encoding.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

ResumeRecord ParseResumeText(const std::string& text,
                             const std::filesystem::path& path) {
  const auto is_shallow = [](int depth, Json::parse_event_t, Json&) {
    return depth <= kMaxDepth;
  };
  try {
    return ToRecord(Json::parse(text, is_shallow, /*allow_exceptions=*/false));
  } catch (const Damage&) {
    throw FileError(path,
                    "damaged, or of another version of the program; start "
                    "anew, without --resume");
  }
}

}  // namespace colmap_ext
