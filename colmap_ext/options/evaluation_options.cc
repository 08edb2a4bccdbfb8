#include "colmap_ext/options/evaluation_options.h"

#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/words.h"
#include "formats/read_npy_mask.h"

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
    throw OptionError(
        fmt::format("{}: '{}' should be {} numbers", option, text, count));
  }
  return numbers;
}

}  // namespace

void EvaluatorOptions::Finish() {
  if (mesh_path.empty() || truth_path.empty()) {
    throw OptionError("--mesh_path and --truth_path are required");
  }
  region.Finish();
  if (region.is_auto && workspace_path.empty()) {
    throw OptionError("--region auto needs --workspace_path");
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
  if (!sparse_path.empty() && workspace_path.empty()) {
    throw OptionError("--sparse_path needs --workspace_path");
  }
  if (!std::isfinite(error_scale) || error_scale < 0) {
    throw OptionError("error_scale must be a length, or 0");
  }
  CheckNumThreads(num_threads);
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
    VoxelGrid grid = ReadNpyMask(observability_mask);
    observability.mask = ObservabilityMask{
        grid.size, std::move(grid.voxels), {box[0], box[1], box[2]}, box[3]};
  }
  if (!ground_plane.empty()) {
    observability.ground_plane =
        Eigen::Vector4d(ParseNumbers("ground_plane", ground_plane, 4).data());
  }
  return observability;
}

}  // namespace colmap_ext
