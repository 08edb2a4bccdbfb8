#include "colmap_ext/jobs/refinement_state.h"

#include <array>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "colmap_ext/jobs/job_file.h"
#include "formats/errors.h"
#include "mesh/topology.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

constexpr JobFileKind kStateKind = {"CESTATE1", "start anew, without --resume"};

// What is refined of a view: fx, fy, cx, cy, the rotation by columns, the
// translation.
using CameraNumbers = std::array<double, 16>;

std::vector<CameraNumbers> CameraNumbersOf(const std::vector<View>& views) {
  std::vector<CameraNumbers> all;
  for (const View& view : views) {
    CameraNumbers& numbers =
        all.emplace_back(CameraNumbers{view.fx, view.fy, view.cx, view.cy});
    Eigen::Map<Eigen::Matrix3d>(numbers.data() + 4) =
        view.cam_from_world_rotation;
    Eigen::Map<Eigen::Vector3d>(numbers.data() + 13) =
        view.cam_from_world_translation;
  }
  return all;
}

void SetCameraNumbers(const CameraNumbers& numbers, View* view) {
  view->fx = numbers[0];
  view->fy = numbers[1];
  view->cx = numbers[2];
  view->cy = numbers[3];
  view->cam_from_world_rotation =
      Eigen::Map<const Eigen::Matrix3d>(&numbers[4]);
  view->cam_from_world_translation =
      Eigen::Map<const Eigen::Vector3d>(&numbers[13]);
}

// Names and values, each with a null character behind it.
std::vector<char> ValuesText(const JobInputs::Values& values) {
  std::vector<char> text;
  for (const auto& [name, value] : values) {
    text.insert(text.end(), name.c_str(), name.c_str() + name.size() + 1);
    text.insert(text.end(), value.c_str(), value.c_str() + value.size() + 1);
  }
  return text;
}

JobInputs::Values ValuesFrom(const std::vector<char>& text) {
  JobInputs::Values values;
  std::istringstream stream(std::string(text.begin(), text.end()));
  for (std::string name, value;
       std::getline(stream, name, '\0') && std::getline(stream, value, '\0');) {
    values[name] = value;
  }
  return values;
}

// The counts of a report that go into the state.
auto CountsOf(RefinementReport* report) {
  return std::tie(report->num_shortened_steps,
                  report->num_unconverged_solutions, report->num_flipped_facets,
                  report->num_removed_self_intersections);
}

}  // namespace

fs::path StatePath(const fs::path& output) {
  return output.string() + ".resume";
}

void ExpectManifold(const TriangleMesh& mesh) {
  if (const MeshReport report = Analyze(mesh); !report.IsManifold()) {
    throw std::logic_error("the refined mesh has " + report.Defects());
  }
}

void WriteState(const fs::path& output, const JobInputs& inputs,
                const RefinementState& state) {
  ExpectManifold(state.mesh);
  RefinementReport report = state.report;
  const Misalignment misalignment =
      report.misalignment.value_or(Misalignment());
  const auto [shortened, unconverged, flipped, removed] = CountsOf(&report);
  const VertexAttributes& attributes = state.attributes;
  JobFileWriter file(StatePath(output), kStateKind, 0);
  file.Add(ValuesText(inputs.options), ValuesText(inputs.files), state.level,
           state.mesh.vertices, state.mesh.facets, attributes.colors,
           attributes.views, attributes.confidences, state.origins,
           state.fixed_sources, CameraNumbersOf(state.views),
           report.misalignment.has_value(), misalignment.by_cameras,
           misalignment.of_surface, misalignment.by_view, shortened,
           unconverged, flipped, removed, report.labelings, report.steps);
  file.Commit();
}

RefinementState ReadState(const fs::path& output, const JobInputs& inputs,
                          const std::vector<View>& views) {
  const fs::path path = StatePath(output);
  const JobFileReader file(path, kStateKind, 0);
  const JobInputs earlier = {ValuesFrom(file.ReadAll<char>(0)),
                             ValuesFrom(file.ReadAll<char>(1))};
  if (const std::string difference = inputs.DifferenceTo(earlier);
      !difference.empty()) {
    throw FileError(path, "belongs to another run: " + difference +
                              "; go on as it was begun, or " +
                              kStateKind.what_to_do);
  }
  RefinementState state;
  std::vector<CameraNumbers> cameras;
  bool has_misalignment = false;
  Misalignment misalignment;
  VertexAttributes& attributes = state.attributes;
  const auto [shortened, unconverged, flipped, removed] =
      CountsOf(&state.report);
  file.ReadFrom(2, &state.level, &state.mesh.vertices, &state.mesh.facets,
                &attributes.colors, &attributes.views, &attributes.confidences,
                &state.origins, &state.fixed_sources, &cameras,
                &has_misalignment, &misalignment.by_cameras,
                &misalignment.of_surface, &misalignment.by_view, &shortened,
                &unconverged, &flipped, &removed, &state.report.labelings,
                &state.report.steps);
  if (has_misalignment) {
    state.report.misalignment = std::move(misalignment);
  }
  state.views = views;
  for (size_t i = 0; i < views.size(); ++i) {
    SetCameraNumbers(cameras.at(i), &state.views[i]);
  }
  return state;
}

void RemoveState(const fs::path& output) {
  std::error_code ignored;
  fs::remove(StatePath(output), ignored);
}

}  // namespace colmap_ext
