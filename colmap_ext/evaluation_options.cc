#include "colmap_ext/evaluation_options.h"

#include <charconv>
#include <cmath>
#include <vector>

#include "colmap_ext/errors.h"
#include "colmap_ext/read_npy_mask.h"

namespace colmap_ext {

namespace {

[[noreturn]] void ThrowNotNumbers(const std::string& option,
                                  const std::string& text) {
  throw OptionError(option + ": '" + text +
                    "' is not a list of numbers separated by commas");
}

// Numbers separated by commas.
// \param count  how many there have to be; 0: one or more
std::vector<double> ParseNumbers(const std::string& option,
                                 const std::string& text, size_t count) {
  std::vector<double> numbers;
  const char* begin = text.data();
  const char* const end = begin + text.size();
  while (true) {
    double number = 0;
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || !std::isfinite(number) ||
        (rest != end && *rest != ',')) {
      ThrowNotNumbers(option, text);
    }
    numbers.push_back(number);
    if (rest == end) {
      break;
    }
    begin = rest + 1;
  }
  if (count > 0 && numbers.size() != count) {
    throw OptionError(option + ": '" + text + "' should be " +
                      std::to_string(count) + " numbers");
  }
  return numbers;
}

void AddPathOptions(colmap::OptionManager* manager,
                    EvaluatorOptions* evaluator) {
  manager->AddDefaultOption("mesh_path", &evaluator->mesh_path,
                            "The mesh, PLY; required");
  manager->AddDefaultOption(
      "truth_path", &evaluator->truth_path,
      "What is true, in the same frame: a mesh or points, PLY, or a folder of "
      "COLMAP's depth maps IMAGE_NAME[.geometric].bin; required");
  manager->AddDefaultOption(
      "workspace_path", &evaluator->workspace_path,
      "Count only what the images of this workspace or sparse model see, and "
      "compare depths; undistorted images only");
  manager->AddDefaultOption("json_path", &evaluator->json_path,
                            "The figures as JSON");
  manager->AddDefaultOption(
      "error_mesh_path", &evaluator->error_mesh_path,
      "The mesh coloured by its vertices' distances to the truth, PLY");
  manager->AddDefaultOption("picture_path", &evaluator->picture_path,
                            "A picture of that with its scale, PNG");
  manager->AddDefaultOption("picture_image", &evaluator->picture_image,
                            "... seen by the workspace's image of this name");
}

void AddObservabilityOptions(colmap::OptionManager* manager,
                             EvaluatorOptions* evaluator) {
  manager->AddDefaultOption(
      "observability_mask", &evaluator->observability_mask,
      "Count samples of the mesh only where this NumPy array [X,Y,Z] of uint8 "
      "is not 0 (DTU's ObsMask)");
  manager->AddDefaultOption("observability_box", &evaluator->observability_box,
                            "minx,miny,minz,resolution of that array (DTU's "
                            "BB(1,:) and Res)");
  manager->AddDefaultOption(
      "ground_plane", &evaluator->ground_plane,
      "a,b,c,d: count samples of the truth only where ax+by+cz+d > 0 (DTU's "
      "Plane)");
}

}  // namespace

void EvaluatorOptions::Finish() {
  if (mesh_path.empty() || truth_path.empty()) {
    throw OptionError("--mesh_path and --truth_path are required");
  }
  if (observability_mask.empty() != observability_box.empty()) {
    throw OptionError(
        "--observability_mask and --observability_box go together");
  }
  if (!picture_image.empty() &&
      (workspace_path.empty() || picture_path.empty())) {
    throw OptionError(
        "--picture_image needs --picture_path and --workspace_path");
  }
  if (!std::isfinite(error_scale) || error_scale < 0) {
    throw OptionError("error_scale must be a length, or 0");
  }
  if (num_threads != -1 && num_threads <= 0) {
    throw OptionError("num_threads must be positive, or -1 for all threads");
  }
  evaluation.depth_thresholds =
      ParseNumbers("depth_thresholds", depth_thresholds, 0);
  if (const std::string error = evaluation.Check(); !error.empty()) {
    throw OptionError(error);
  }
}

Observability EvaluatorOptions::ReadObservability() const {
  Observability observability;
  if (!observability_mask.empty()) {
    const std::vector<double> box =
        ParseNumbers("observability_box", observability_box, 4);
    if (!(box[3] > 0)) {
      throw OptionError("observability_box: the resolution must be positive");
    }
    observability.mask = ReadNpyMask(observability_mask);
    observability.mask->origin = {box[0], box[1], box[2]};
    observability.mask->resolution = box[3];
  }
  if (!ground_plane.empty()) {
    observability.ground_plane =
        Eigen::Vector4d(ParseNumbers("ground_plane", ground_plane, 4).data());
  }
  return observability;
}

void AddEvaluatorOptions(colmap::OptionManager* manager,
                         EvaluatorOptions* evaluator) {
  AddPathOptions(manager, evaluator);
  AddObservabilityOptions(manager, evaluator);
  MeshEvaluationOptions* evaluation = &evaluator->evaluation;
  manager->AddDefaultOption("MeshEvaluation.stride", &evaluation->stride,
                            "Of the pixels that are cast");
  manager->AddDefaultOption(
      "MeshEvaluation.spacing", &evaluation->spacing,
      "Samples are one for each cube of this side, scene units; 0: 0.001 times "
      "the truth's diagonal; DTU: 0.2 mm");
  manager->AddDefaultOption(
      "MeshEvaluation.max_distance", &evaluation->max_distance,
      "Distances are clipped at this, scene units; 0: 0.05 times the truth's "
      "diagonal; DTU: 20 mm");
  manager->AddDefaultOption(
      "MeshEvaluation.drop_beyond", &evaluation->drop_beyond,
      "Leave distances beyond out, as DTU's own evaluation does");
  manager->AddDefaultOption(
      "MeshEvaluation.depth_thresholds", &evaluator->depth_thresholds,
      "Depths are right below these errors, scene units; EPFL: 0.02,0.1 m");
  manager->AddDefaultOption("MeshEvaluation.error_scale",
                            &evaluator->error_scale,
                            "Error at the end of the colours, scene units; 0: "
                            "above 95 % of the errors");
  manager->AddDefaultOption("MeshEvaluation.num_threads",
                            &evaluator->num_threads,
                            "-1 for all; the result does not depend on it");
}

}  // namespace colmap_ext
